"""Hand poses in the world: rest poses, gesture keys and their distances."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import sqrt
from types import MappingProxyType

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.hands.blending import angle_between
from kinesic.expressivity.hands.world_paths import paths_in_world, shoulder
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.hand_shapes import FingerMotion
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.lexicon.space import (
    direction_in_world,
    pull_within_reach,
    to_world,
    widen_key,
)
from kinesic.expressivity.style.effort import PLAIN_TRAITS, GestureTraits
from kinesic.expressivity.style.style import Expressivity

REST_HAND = Hand()  # hand at rest
_ROTATION_LEVER = 0.15  # [m/rad] distance of a hand movement that takes as long as a rotation
_START_WITHDRAWAL = 0.15  # fraction of the distance to rest at which the stroke of a one-key form begins
_POINTING_REACH = 0.98  # [arm lengths] largest distance of a pointing wrist from the shoulder
_DYNAMIC_DISTANCE = 0.25  # [arm lengths] length above which a stroke is dynamic, not a pose
_SAME_KEY_DISTANCE = 0.1  # [arm lengths] distance below which one key counts as a repetition of another
_TARGET_FRACTION = 0.8  # fraction of the distance to a near target at which the pointing wrist stops
_FORM_OPENNESS = 0.4  # largest openness that a form sets; expressivity adds the rest


@dataclass(frozen=True, eq=False)
class Poses:
    """World poses of the participating hands at the keys of a stroke."""

    hands: Mapping[Side, tuple[Hand, ...]]  # poses by side, at the same keys for both hands
    stroke: int  # index of the key at the sync point `stroke`
    paths: Mapping[Side, tuple[HandPath | None, ...]] = field(default_factory=dict)  # [m] path to each key, world axes
    again: tuple[int, ...] = ()  # indices of the keys at `stroke:2`, `stroke:3` and so on
    traits: GestureTraits = PLAIN_TRAITS  # properties that determine durations and accents
    body: BodyForm = NO_BODY  # accompanying body motion
    fingers: FingerMotion | None = None  # finger motion during the stroke

    @property
    def count(self) -> int:
        """Number of stroke keys."""
        return max((len(row) for row in self.hands.values()), default=0)

    @property
    def stroke_count(self) -> int:
        """Number of strokes, repetitions included."""
        return 1 + len(self.again)

    def path(self, side: Side, key: int) -> HandPath | None:
        """Return the hand path that ends at a key, None if straight."""
        return self.paths[side][key] if side in self.paths else None

    def with_effort(self, weight: float) -> "Poses":
        """Return the poses with a new effort profile weight, 0 to 1."""
        return replace(self, traits=replace(self.traits, weight=weight))

    def only(self, side: Side) -> "Poses":
        """Return the keys and paths of one hand only."""
        paths = {side: self.paths[side]} if side in self.paths else {}
        return replace(self, hands={side: self.hands[side]}, paths=paths)

    def fewer(self) -> "Poses":
        """Return the poses without the last repetition of the stroke."""
        stroke_keys = (self.stroke, *self.again)
        count = self.count - (stroke_keys[-1] - stroke_keys[-2])
        hands = {side: row[:count] for side, row in self.hands.items()}
        paths = {side: row[:count] for side, row in self.paths.items()}
        return replace(self, hands=hands, paths=paths, again=self.again[:-1])


@lru_cache(maxsize=8)
def resting_hands(robot: Robot) -> Mapping[Side, Reach]:
    """Return the world hand poses of the robot's rest posture, by side."""
    frames = robot.skeleton.rest_frames
    reaches: dict[Side, Reach] = {}
    for side in SIDES:
        palm = robot.arm(side).palm
        k = robot.skeleton.segment(palm.segment)
        rotation = frames.rotations[k]
        along = rotation @ palm.position
        reaches[side] = Reach(
            position=sealed(frames.origins[k]),
            pointing=sealed(along / np.linalg.norm(along)),
            palm=sealed(rotation @ palm.facing),
        )
    return MappingProxyType(reaches)


def poses(form: GestureForm, robot: Robot, manner: Expressivity) -> Poses:
    """Convert a gesture's stroke keys to hand poses in the world.

    A hand that a key omits keeps its pose in the key before, at first the rest pose. A form of one key gets a start key
    closer to rest, so that its stroke is visible. Repetition adds up to two strokes; below 0 it removes one where the
    form has more than one.

    Args:
        form: with at least one key.
        robot: in whose gesture space the form is performed.
        manner: expressivity of the behaviour.

    Returns:
        For each side that takes part, at least two keys; the middle key of each repetition is the stroke.
    """
    in_world = _convert_keys(form.keys, robot, manner)
    extra = round(2 * manner.repetition) if manner.repetition > 0 else -round(-manner.repetition)
    stroke_count = 1 if form.rest or form.stays else max(1, in_world.stroke_count + extra)
    again = tuple(in_world.count // 2 + k * (in_world.count - in_world.back) for k in range(1, stroke_count))
    hands = {
        side: _lift_shoulder(row, in_world.count // 2, form.body.shoulders) for side, row in in_world.hands.items()
    }
    return Poses(
        {side: row + row[in_world.back :] * (stroke_count - 1) for side, row in hands.items()},
        in_world.count // 2,
        {side: row + row[in_world.back :] * (stroke_count - 1) for side, row in in_world.paths.items()},
        again,
        GestureTraits(form.category, form.tempo, dynamic=in_world.travels),
        form.body,
        form.fingers,
    )


@dataclass(frozen=True, eq=False)
class _InWorld:
    """Hand poses and paths of one stroke in world coordinates."""

    hands: Mapping[Side, tuple[Hand, ...]]
    paths: Mapping[Side, tuple[HandPath | None, ...]]
    count: int  # number of keys of the stroke, at least two
    stroke_count: int  # number of strokes in the gesture form
    back: int  # 1 if the stroke ends at its start position, otherwise 0
    travels: bool  # whether a hand moves farther than `_DYNAMIC_DISTANCE`


@lru_cache(maxsize=64)  # looked up for durations and for hands, which differ only in the body motion
def _convert_keys(form_keys: tuple[StrokeKey, ...], robot: Robot, manner: Expressivity) -> _InWorld:
    once, stroke_count = _find_repetition(form_keys)
    keys = [widen_key(key, manner.spatial, robot) for key in form_keys[:once]]
    sides = frozenset(side for key in form_keys for side in key.hands)
    hands = {side: _hands_of(keys, side, robot, manner) for side in sides}
    paths = {side: paths_in_world(form_keys[:once], row, side, robot, manner.spatial) for side, row in hands.items()}
    travels = _is_dynamic(hands, paths, robot, stroke_count)
    if once == 1:
        hands = {side: (withdrawn(hand, robot, side), hand) for side, (hand,) in hands.items()}
        paths = {side: (None, *row) for side, row in paths.items()}
    back = 1 if all(_same_position(row[0], row[-1]) for row in hands.values()) else 0
    return _InWorld(hands, paths, max(once, 2), stroke_count, back, travels)


def pointing_poses(target: Floats, side: Side, robot: Robot, shape: str = "index") -> Poses:
    """Return the hand poses of pointing at a position.

    The wrist is on the line from the shoulder to the place, the hand along it.

    Args:
        target: (3,) [m] in the world.
        side: of the hand that points.
        robot: that has the arm.
        shape: of the hand.
    """
    centre = shoulder(robot, side)
    distance = float(np.linalg.norm(target - centre))
    line = (target - centre) / distance if distance > 0 else np.array([1.0, 0.0, 0.0])
    reach = min(_POINTING_REACH * robot.arm_length, _TARGET_FRACTION * distance)
    hand = Hand(Reach(sealed(centre + reach * line), pointing=sealed(line)), aim=sealed(target), shape=shape)
    return Poses({side: (withdrawn(hand, robot, side), hand)}, stroke=1, traits=GestureTraits("deictic", dynamic=False))


def withdrawn(hand: Hand, robot: Robot, side: Side) -> Hand:
    """Move a hand slightly towards rest and remove its body contact."""
    if hand.reach is None:
        return hand
    rest = resting_hands(robot)[side].position
    position = hand.reach.position + _START_WITHDRAWAL * (rest - hand.reach.position)
    return replace(hand, reach=structs.replace(hand.reach, position=sealed(position)), touch=None, tip=None)


def _lift_shoulder(row: tuple[Hand, ...], stroke: int, lift: float) -> tuple[Hand, ...]:
    """Raise the shoulder in hand poses, half as far before the stroke."""
    return tuple(replace(hand, lift=lift if k >= stroke else lift / 2) for k, hand in enumerate(row)) if lift else row


def pose_distance(a: Hand, b: Hand, rest: Reach) -> float:
    """Return the distance between two hand poses [m].

    It is the distance of the wrists, or that of a lever rotated with the hand if longer. A hand without reach hangs in
    the pose `rest`.
    """
    start, end = a.reach or rest, b.reach or rest
    turn = max(angle_between(start.palm, end.palm), angle_between(start.pointing, end.pointing))
    step = start.position - end.position
    return max(sqrt(step @ step), _ROTATION_LEVER * turn)


def _is_dynamic(
    hands: Mapping[Side, Sequence[Hand]], paths: Mapping[Side, Sequence[HandPath | None]], robot: Robot, count: int
) -> bool:
    """Return whether a hand travels farther than `_DYNAMIC_DISTANCE` in `count` strokes.

    The returns between them count. If a hand touches something, a single stroke counts.
    """
    count = 1 if any(hand.touch for row in hands.values() for hand in row) else count
    for side, row in hands.items():
        places = [(hand.reach or resting_hands(robot)[side]).position for hand in row]
        steps = zip(places, places[1:], paths[side][1:], strict=False)
        stroke = sum(path.length(a, b) if path else float(np.linalg.norm(b - a)) for a, b, path in steps)
        back = float(np.linalg.norm(places[-1] - places[0]))
        if count * stroke + (count - 1) * back > _DYNAMIC_DISTANCE * robot.arm_length:
            return True
    return False


def _find_repetition(keys: Sequence[StrokeKey]) -> tuple[int, int]:
    """Return the length [keys] and count of a repeated key sequence.

    A form that does not repeat to its end has count 1.
    """
    for once in range(2, len(keys) // 2 + 1):
        repetitions, left = divmod(len(keys), once)
        if not left and all(_are_same_keys(keys[k], keys[k - once]) for k in range(once, len(keys))):
            return once, repetitions
    return len(keys), 1


def _are_same_keys(a: StrokeKey, b: StrokeKey) -> bool:
    """Return whether two keys have nearly equal hand positions and no paths."""
    return a.hands.keys() == b.hands.keys() and all(
        pose.path is b.hands[side].path is None
        and float(np.linalg.norm(pose.position - b.hands[side].position)) < _SAME_KEY_DISTANCE
        for side, pose in a.hands.items()
    )


def _same_position(a: Hand, b: Hand) -> bool:
    if a.reach is None or b.reach is None:
        return a.reach is b.reach
    return bool(np.allclose(a.reach.position, b.reach.position, atol=1e-9))


def _hands_of(keys: list[StrokeKey], side: Side, robot: Robot, manner: Expressivity) -> tuple[Hand, ...]:
    """Return the world poses of one hand at all stroke keys.

    A key without the hand repeats its pose.
    """
    hands, hand = [], REST_HAND
    for key in keys:
        if side in key.hands:
            hand = _in_world(key.hands[side], side, robot, manner)
        hands.append(hand)
    return tuple(hands)


def _in_world(pose: HandPose, side: Side, robot: Robot, manner: Expressivity) -> Hand:
    openness = _FORM_OPENNESS * pose.openness
    position = pull_within_reach(pose.position, robot) if pose.captured else pose.position
    return Hand(
        Reach(
            position=to_world(robot, side, position),
            pointing=None if pose.pointing is None else direction_in_world(side, pose.pointing),
            palm=None if pose.palm is None else direction_in_world(side, pose.palm),
        ),
        aim=pose.aim,
        touch=pose.touch,
        tip=pose.tip,
        openness=openness + (1.0 - openness) * manner.openness,
        effort=max(0.0, manner.power),
        shape=pose.shape,
    )
