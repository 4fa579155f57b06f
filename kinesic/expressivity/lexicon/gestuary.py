"""Reader of Greta's gestuaries: gestures in XML (thesis 8.7)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NoReturn, TypeVar

import numpy as np

from kinesic.bml.block import BmlError, DocumentBounds
from kinesic.bml.reading.manner import scale_openness
from kinesic.bml.reading.tree import Element, read_tree
from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Side
from kinesic.body.rotation import quaternion_to_rotation
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.paths import HandPath, PathKind, SizeTrend, Three, shape_path
from kinesic.expressivity.lexicon.space import position

_SIDE_NAMES: Mapping[str, Side] = {"left": "l", "right": "r"}
GESTUARY_BOUNDS = DocumentBounds(size=40_000_000, elements=1_000_000)  # limits of a file: [bytes] and XML elements

_INHERITED_SHAPE = "empty"  # value of a hand shape that keeps the previous shape
_TRUTH_VALUES: Mapping[str, bool] = {"true": True, "1": True, "false": False, "0": False}

# Wrist positions in gesture space in front of Greta's touch points: outward, up, forward [arm lengths].
_TOUCH_POINTS: Mapping[str, tuple[float, float, float]] = {
    "belly": (0.16, 0.08, 0.40),
    "chest": (0.16, 0.32, 0.38),
    "chin": (0.14, 0.70, 0.36),
    "nose": (0.16, 0.80, 0.38),
    "skulltop": (0.30, 1.20, 0.20),
    "hipwide": (0.46, -0.10, 0.12),
}

_PATH_KINDS: Mapping[str, PathKind] = {name: name for name in ("line", "arc", "circle", "wave", "spiral")}
_SIZE_TRENDS: Mapping[str, SizeTrend] = {"none": "none", "greater": "grows", "smaller": "shrinks"}

# Proportions of an average body [arm lengths], from which the orientation of the forearm is estimated.
_SHOULDER_POSITION = sealed([0.0, 0.37, 0.52])  # [arm lengths] shoulder in gesture space: forward, outward, up
_BONE_LENGTH = 0.5  # [arm lengths] length of upper arm and of forearm
_STRAIGHT_WRIST_COSINE = 0.94  # cosine of 20 deg; a hand closer to the forearm's line needs no pointing direction


Listed = TypeVar("Listed")


@dataclass(frozen=True)
class _Reader:
    """Reader of XML elements that reports file and line in errors."""

    path: Path

    def fail(self, element: Element, problem: str) -> NoReturn:
        raise ConfigError(f"{self.path}:{element.place.line}: <{element.name}> {problem}")

    def attribute(self, element: Element, name: str) -> str:
        if name not in element.attributes:
            self.fail(element, f"has no {name}{suggestion(name, list(element.attributes))}")
        return element.attributes[name]

    def number(self, element: Element, name: str, default: str | None = None) -> float:
        text = self.attribute(element, name) if default is None else element.attributes.get(name, default)
        try:
            value = float(text)
        except ValueError:
            self.fail(element, f"{name} is {text!r}, not a number")
        if not np.isfinite(value):
            self.fail(element, f"{name} is {text}, must be a finite number")
        return value

    def child(self, element: Element, name: str) -> Element:
        child = _first(element, name)
        if child is None:
            self.fail(element, f"has no <{name}>")
        return child

    def listed(self, element: Element, name: str, values: Mapping[str, Listed], default: str) -> Listed:
        text = element.attributes.get(name, default)
        if text.lower() not in values:
            self.fail(element, f"{name} is {text!r}{suggestion(text.lower(), list(values))}")
        return values[text.lower()]

    def truth(self, element: Element, name: str) -> bool:
        return self.listed(element, name, _TRUTH_VALUES, "false")


def read_gestuary(path: Path) -> tuple[GestureForm, ...]:
    """Read all gestures of a gestuary, including disabled and empty ones.

    See `is_enabled`.

    Raises:
        ConfigError: the file is missing, is no gestuary, or contains an invalid gesture.
    """
    try:
        root = read_tree(path.read_bytes(), source=str(path), bounds=GESTUARY_BOUNDS)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except BmlError as error:
        raise ConfigError(str(error)) from None
    if root.local != "gestuary":
        raise ConfigError(f"{path}:{root.place.line}: root is <{root.name}>, a gestuary begins with <gestuary>")
    reader = _Reader(path)
    return tuple(_form(reader, gesture) for gesture in _all(root, "gesture"))


def is_enabled(form: GestureForm) -> bool:
    """Return whether a gesture moves a hand and is not disabled.

    The prefix `zz` of its category disables a gesture.
    """
    return bool(form.sides) and not form.category.lower().startswith("zz")


def _all(element: Element, name: str) -> list[Element]:
    return [child for child in element.children if child.local == name]


def _first(element: Element, *names: str) -> Element | None:
    return next((child for child in element.children if child.local in names), None)


def _form(reader: _Reader, gesture: Element) -> GestureForm:
    """Read one gesture element.

    Each phase inherits unspecified values from the previous one.
    """
    hands: dict[Side, HandPose] = {}
    keys = []
    for phase in _all(gesture, "phase"):
        posed = {}
        for hand in _all(phase, "hand"):
            name = reader.attribute(hand, "side").lower()
            if name not in _SIDE_NAMES:
                reader.fail(hand, f"side is {name!r}, must be LEFT or RIGHT")
            side = _SIDE_NAMES[name]
            pose = _pose(reader, hand, side, hands.get(side))
            if pose is not None:
                posed[side] = hands[side] = pose
        if posed:
            keys.append(StrokeKey(posed))
    category = gesture.attributes.get("category", "")
    keys_with_paths = _defer_first_paths(keys)
    return GestureForm(reader.attribute(gesture, "id"), category, keys_with_paths, rest=category.lower() == "rest")


def _defer_first_paths(keys: Sequence[StrokeKey]) -> tuple[StrokeKey, ...]:
    """Move each hand's path from its first key to its second.

    A path needs a start position, which the first key does not have.
    """
    waiting: dict[Side, HandPath] = {}
    seen_sides: set[Side] = set()
    keys_with_paths = []
    for key in keys:
        hands = {}
        for side, pose in key.hands.items():
            if side not in seen_sides and pose.path is not None:
                waiting[side] = pose.path
                hands[side] = replace(pose, path=None)
            else:
                hands[side] = replace(pose, path=pose.path or waiting.pop(side, None))
            seen_sides.add(side)
        keys_with_paths.append(StrokeKey(hands))
    return tuple(keys_with_paths)


def _pose(reader: _Reader, hand: Element, side: Side, before: HandPose | None) -> HandPose | None:
    """Read the pose of one hand in one phase.

    Returns:
        None before the hand's first position.
    """
    place = _place(reader, hand, side)
    if place is not None:
        place_position, fixed = place
        pose = (
            HandPose(place_position, fixed) if before is None else replace(before, position=place_position, fixed=fixed)
        )
    elif before is not None:
        pose = before
    else:
        return None
    trajectory = _first(hand, "Trajectory", "trajectory")
    pose = replace(pose, path=None if trajectory is None else _path(reader, trajectory))
    shape = _first(hand, "handShape")
    if shape is not None:
        name = reader.attribute(shape, "value").lower()
        pose = pose if name == _INHERITED_SHAPE else replace(pose, shape=name)
    turn = _first(hand, "wristOrientation")
    if turn is not None:
        pose = _orient(reader, turn, side, pose)
    return replace(pose, openness=scale_openness(reader.number(hand, "openness", "0")))


def _place(reader: _Reader, hand: Element, side: Side) -> tuple[Floats, tuple[bool, bool, bool]] | None:
    """Read a hand position and the axes exempt from spatial extent.

    The position is (3,) forward, outward, up [arm lengths]. None if the hand has no position.
    """
    touch = _first(hand, "touchPosition")
    if touch is not None:
        return _touch(reader, touch, side), (True, True, True)
    place = _first(hand, "symbolicPosition", "uniformPosition")
    if place is None:
        return None
    values: list[float | str]
    if not place.children:  # a uniformPosition as the schema has it
        fixed, values = (False, False, False), [reader.number(place, name, "0") for name in "xyz"]
    else:
        axes = x, y, z = [reader.child(place, f"{name}Location") for name in ("horizontal", "vertical", "frontal")]
        fixed = (reader.truth(z, "fixed"), reader.truth(x, "fixed"), reader.truth(y, "fixed"))
        read = reader.number if place.local == "uniformPosition" else reader.attribute
        values = [read(axis, "value") for axis in axes]
    try:
        return position(*values), fixed
    except ValueError as error:
        reader.fail(place, str(error))


def _path(reader: _Reader, trajectory: Element) -> HandPath:
    """Read a hand trajectory with amplitude, frequency and shift of each axis.

    Its elements x, y and z give amplitude, frequency, shift and variations. Missing values of an axis are 0; a
    trajectory without axes has the defaults of its type. The variations are those of the first axis that moves.
    """
    kind = reader.listed(trajectory, "type", _PATH_KINDS, "wave")
    axes = {axis: element for axis in "xyz" for element in [_first(trajectory, axis, axis.upper())] if element}
    if not axes or kind == "line":
        return shape_path(kind)

    def three(name: str) -> Three:
        x, y, z = (reader.number(axes[axis], name, "0") if axis in axes else 0.0 for axis in "xyz")
        return x, y, z

    size = three("amplitude")
    moving = next((axes[axis] for axis, amplitude in zip("xyz", size, strict=True) if amplitude), trajectory)
    try:
        return shape_path(
            kind,
            amplitude=size,
            frequency=three("frequency"),
            shift=three("shift"),
            variations=(
                reader.listed(moving, "spatialVariation", _SIZE_TRENDS, "none"),
                reader.listed(moving, "temporalVariation", _SIZE_TRENDS, "none"),
            ),
        )
    except ValueError as error:
        reader.fail(trajectory, str(error))


def _touch(reader: _Reader, touch: Element, side: Side) -> Floats:
    """Return the position of a touch point such as `chin_L`.

    The letter is the side of the body. The position is (3,) forward, outward, up [arm lengths].
    """
    text = reader.attribute(touch, "value")
    name, _, letter = text.lower().partition("_")
    if name not in _TOUCH_POINTS or letter not in ("", "l", "r"):
        reader.fail(touch, f"value is {text!r}, no touch point{suggestion(name, list(_TOUCH_POINTS))}")
    x, y, z = _TOUCH_POINTS[name]
    return position(x if letter in ("", side) else -x, y, z)


def _orient(reader: _Reader, turn: Element, side: Side, pose: HandPose) -> HandPose:
    """Set palm and pointing directions from a wristOrientation.

    At the unit quaternion a hanging hand points down and its palm faces the body. The quaternion rotates it in
    Greta's axes (x left, y up, z forward): those of the world when it is global, otherwise those of the forearm.
    """
    quaternion = np.array([reader.number(turn, name, "0") for name in "xyzw"])
    if not quaternion.any():
        return pose
    world = reader.truth(turn, "global")
    frame = np.eye(3) if world else _forearm(pose.position, side)
    rotation = frame @ quaternion_to_rotation(quaternion)
    inward = -1.0 if side == "l" else 1.0
    pointing, palm = -rotation[:, 1], inward * rotation[:, 0]
    straight = not world and float(pointing @ -frame[:, 1]) > _STRAIGHT_WRIST_COSINE
    return replace(pose, pointing=None if straight else _to_side_axes(pointing, side), palm=_to_side_axes(palm, side))


def _to_side_axes(direction: Floats, side: Side) -> Floats:
    """Convert Greta's axes (left, up, forward) to forward, outward and up."""
    left, up, forward = direction
    return sealed([forward, left if side == "l" else -left, up])


def _forearm(position: Floats, side: Side) -> Floats:
    """Return the forearm axes for a wrist position with a hanging elbow.

    Args:
        position: (3,) forward, outward, up [arm lengths] of the wrist.
        side: of the hand.

    Returns:
        (3, 3) columns in x left, y up, z forward: x the elbow's axis, y from wrist to elbow.
    """
    shoulder, wrist = (_to_greta_axes(point, side) for point in (_SHOULDER_POSITION, position))
    distance = float(np.linalg.norm(wrist - shoulder))
    along = (wrist - shoulder) / distance if distance > 1e-6 else np.array([0.0, 0.0, 1.0])
    hanging = _unit(np.array([0.0, -1.0, -1e-6]) + along[1] * along)  # downward, at right angles to shoulder-wrist
    half = min(distance / 2, 0.999 * _BONE_LENGTH)
    lift = np.sqrt(_BONE_LENGTH**2 - half**2) * hanging
    upper, y = -half * along - lift, _unit(lift - half * along)
    x = _unit(np.cross(upper, along))
    return np.column_stack([x, y, np.cross(x, y)])


def _unit(vector: Floats) -> Floats:
    return vector / np.linalg.norm(vector)


def _to_greta_axes(point: Floats, side: Side) -> Floats:
    """Convert (forward, outward, up) to Greta's left, up and forward axes."""
    forward, outward, up = point
    return np.array([outward if side == "l" else -outward, up, forward])
