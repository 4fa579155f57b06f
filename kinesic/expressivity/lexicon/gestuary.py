"""Reads Greta's gestuaries: gestures as XML (thesis 8.7)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NoReturn, TypeVar

import numpy as np
import scipy

from kinesic.bml.block import BmlError, Bounds
from kinesic.bml.reading.manner import openness_of
from kinesic.bml.reading.tree import Element, read_tree
from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Side
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.paths import HandPath, PathKind, SizeTrend, Three, shape_path
from kinesic.expressivity.lexicon.space import position

_SIDES: Mapping[str, Side] = {"left": "l", "right": "r"}
LARGEST_GESTUARY = Bounds(size=40_000_000, elements=1_000_000)  # of a lexicon

_INHERITED = "empty"  # the hand shape that means: as before
_TRUTHS: Mapping[str, bool] = {"true": True, "1": True, "false": False, "0": False}

# Greta's touch points as wrists that hover before them [arm lengths], in the order of `space.position`.
_TOUCHES: Mapping[str, tuple[float, float, float]] = {
    "belly": (0.16, 0.08, 0.40),
    "chest": (0.16, 0.32, 0.38),
    "chin": (0.14, 0.70, 0.36),
    "nose": (0.16, 0.80, 0.38),
    "skulltop": (0.30, 1.20, 0.20),
    "hipwide": (0.46, -0.10, 0.12),
}

_KINDS: Mapping[str, PathKind] = {name: name for name in ("line", "arc", "circle", "wave", "spiral")}
_VARIATIONS: Mapping[str, SizeTrend] = {"none": "none", "greater": "grows", "smaller": "shrinks"}

# A body of which only proportions matter, to guess how the forearm of a posture lies [arm lengths].
_SHOULDER = sealed([0.0, 0.37, 0.52])  # forward, outward, up
_BONE = 0.5  # upper arm and forearm alike
_ALONG_FOREARM = 0.94  # cosine of 20 deg: a hand nearer to the forearm's line than this need not be asked to point


Listed = TypeVar("Listed")


@dataclass(frozen=True)
class _Reader:
    """Reads elements of one file; its errors name the file and the line."""

    path: Path

    def fail(self, element: Element, what: str) -> NoReturn:
        raise ConfigError(f"{self.path}:{element.place.line}: <{element.name}> {what}")

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
        return self.listed(element, name, _TRUTHS, "false")


def read_gestuary(path: Path) -> tuple[GestureForm, ...]:
    """Reads all gestures of a gestuary, switched-off and empty ones included (see `is_enabled`).

    Raises:
        ConfigError: the file is missing, is no gestuary, or a gesture in it is wrong.
    """
    try:
        root = read_tree(path.read_bytes(), source=str(path), bounds=LARGEST_GESTUARY)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except BmlError as error:
        raise ConfigError(str(error)) from None
    if root.local != "gestuary":
        raise ConfigError(f"{path}:{root.place.line}: root is <{root.name}>, a gestuary begins with <gestuary>")
    reader = _Reader(path)
    return tuple(_form(reader, gesture) for gesture in _all(root, "gesture"))


def is_enabled(form: GestureForm) -> bool:
    """Whether a gesture is meant to be used: it moves a hand, and no `zz` before its category switches it off."""
    return bool(form.sides) and not form.category.lower().startswith("zz")


def _all(element: Element, name: str) -> list[Element]:
    return [child for child in element.children if child.local == name]


def _first(element: Element, *names: str) -> Element | None:
    return next((child for child in element.children if child.local in names), None)


def _form(reader: _Reader, gesture: Element) -> GestureForm:
    """Reads the form of a gesture; what a phase leaves open is as in the phase before."""
    hands: dict[Side, HandPose] = {}
    keys = []
    for phase in _all(gesture, "phase"):
        posed = {}
        for hand in _all(phase, "hand"):
            name = reader.attribute(hand, "side").lower()
            if name not in _SIDES:
                reader.fail(hand, f"side is {name!r}, must be LEFT or RIGHT")
            side = _SIDES[name]
            pose = _pose(reader, hand, side, hands.get(side))
            if pose is not None:
                posed[side] = hands[side] = pose
        if posed:
            keys.append(StrokeKey(posed))
    category = gesture.attributes.get("category", "")
    moved = _with_somewhere_to_come_from(keys)
    return GestureForm(reader.attribute(gesture, "id"), category, moved, rest=category.lower() == "rest")


def _with_somewhere_to_come_from(keys: Sequence[StrokeKey]) -> tuple[StrokeKey, ...]:
    """A trajectory in the first phase of a hand, which comes from nowhere, leads to the second."""
    waiting: dict[Side, HandPath] = {}
    met: set[Side] = set()
    moved = []
    for key in keys:
        hands = {}
        for side, pose in key.hands.items():
            if side not in met and pose.path is not None:
                waiting[side] = pose.path
                hands[side] = replace(pose, path=None)
            else:
                hands[side] = replace(pose, path=pose.path or waiting.pop(side, None))
            met.add(side)
        moved.append(StrokeKey(hands))
    return tuple(moved)


def _pose(reader: _Reader, hand: Element, side: Side, before: HandPose | None) -> HandPose | None:
    """One hand in one phase; None when nothing has said yet where it is."""
    place = _place(reader, hand, side)
    if place is not None:
        where, fixed = place
        pose = HandPose(where, fixed) if before is None else replace(before, position=where, fixed=fixed)
    elif before is not None:
        pose = before
    else:
        return None
    trajectory = _first(hand, "Trajectory", "trajectory")
    pose = replace(pose, path=None if trajectory is None else _path(reader, trajectory))
    shape = _first(hand, "handShape")
    if shape is not None:
        name = reader.attribute(shape, "value").lower()
        pose = pose if name == _INHERITED else replace(pose, shape=name)
    turn = _first(hand, "wristOrientation")
    if turn is not None:
        pose = _turned(reader, turn, side, pose)
    return replace(pose, openness=openness_of(reader.number(hand, "openness", "0")))


def _place(reader: _Reader, hand: Element, side: Side) -> tuple[Floats, tuple[bool, bool, bool]] | None:
    """Where a hand is, (3,) forward, outward, up [arm lengths], and the axes that are fixed."""
    touch = _first(hand, "touchPosition")
    if touch is not None:
        return _touch(reader, touch, side), (True, True, True)
    place = _first(hand, "symbolicPosition", "uniformPosition")
    if place is None:
        return None
    if not place.children:  # a uniformPosition as the schema has it
        return position(*(reader.number(place, name, "0") for name in "xyz")), (False, False, False)
    x, y, z = (reader.child(place, name) for name in ("horizontalLocation", "verticalLocation", "frontalLocation"))
    fixed = (reader.truth(z, "fixed"), reader.truth(x, "fixed"), reader.truth(y, "fixed"))
    if place.local == "uniformPosition":
        return position(*(reader.number(axis, "value") for axis in (x, y, z))), fixed
    try:
        return position(*(reader.attribute(axis, "value") for axis in (x, y, z))), fixed
    except ValueError as error:
        reader.fail(place, str(error))


def _path(reader: _Reader, trajectory: Element) -> HandPath:
    """A trajectory: its type, and for each axis an element x, y or z with amplitude, frequency, shift and variations.

    What an axis leaves out is 0; a trajectory without axes is as usual for its type. The variations are those of the
    first axis that moves.
    """
    kind = reader.listed(trajectory, "type", _KINDS, "wave")
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
                reader.listed(moving, "spatialVariation", _VARIATIONS, "none"),
                reader.listed(moving, "temporalVariation", _VARIATIONS, "none"),
            ),
        )
    except ValueError as error:
        reader.fail(trajectory, str(error))


def _touch(reader: _Reader, touch: Element, side: Side) -> Floats:
    """(3,) forward, outward, up [arm lengths] of a touch point such as `chin_L`; the letter is the body's side."""
    text = reader.attribute(touch, "value")
    name, _, letter = text.lower().partition("_")
    if name not in _TOUCHES or letter not in ("", "l", "r"):
        reader.fail(touch, f"value is {text!r}, no touch point{suggestion(name, list(_TOUCHES))}")
    x, y, z = _TOUCHES[name]
    return position(x if letter in ("", side) else -x, y, z)


def _turned(reader: _Reader, turn: Element, side: Side, pose: HandPose) -> HandPose:
    """A pose with the directions of a wristOrientation.

    At the unit quaternion a hanging hand points down and its palm faces the body. The quaternion turns it in
    Greta's axes (x left, y up, z forward): those of the world when it is global, else those of the forearm.
    """
    quaternion = np.array([reader.number(turn, name, "0") for name in "xyzw"])
    if not quaternion.any():
        return pose
    world = reader.truth(turn, "global")
    frame = np.eye(3) if world else _forearm(pose.position, side)
    rotation = frame @ scipy.spatial.transform.Rotation.from_quat(quaternion).as_matrix()
    inward = -1.0 if side == "l" else 1.0
    pointing, palm = -rotation[:, 1], inward * rotation[:, 0]
    straight = not world and float(pointing @ -frame[:, 1]) > _ALONG_FOREARM
    return replace(pose, pointing=None if straight else _own(pointing, side), palm=_own(palm, side))


def _own(direction: Floats, side: Side) -> Floats:
    """(3,) x left, y up, z forward as forward, outward, up of a side."""
    left, up, forward = direction
    return sealed([forward, left if side == "l" else -left, up])


def _forearm(position: Floats, side: Side) -> Floats:
    """(3, 3) axes of the forearm in x left, y up, z forward, the elbow hanging: x its hinge, y from wrist to elbow.

    Args:
        position: (3,) forward, outward, up [arm lengths] of the wrist.
        side: of the hand.
    """
    shoulder, wrist = (_body(point, side) for point in (_SHOULDER, position))
    distance = float(np.linalg.norm(wrist - shoulder))
    along = (wrist - shoulder) / distance if distance > 1e-6 else np.array([0.0, 0.0, 1.0])
    hanging = _unit(np.array([0.0, -1.0, -1e-6]) + along[1] * along)  # downward, at right angles to the reach
    half = min(distance / 2, 0.999 * _BONE)
    lift = np.sqrt(_BONE**2 - half**2) * hanging
    upper, y = -half * along - lift, _unit(lift - half * along)
    x = _unit(np.cross(upper, along))
    return np.column_stack([x, y, np.cross(x, y)])


def _unit(vector: Floats) -> Floats:
    return vector / np.linalg.norm(vector)


def _body(point: Floats, side: Side) -> Floats:
    """(3,) forward, outward, up of a side as x left, y up, z forward."""
    forward, outward, up = point
    return np.array([outward if side == "l" else -outward, up, forward])
