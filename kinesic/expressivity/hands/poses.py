"""Hands in the world: where they rest, where the poses of a form are, and how far it is from one to another."""

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
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.hand_shapes import FingerMotion
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.lexicon.space import EASY_REACH, direction_in_world, extend_position, to_world, widen_key
from kinesic.expressivity.style.effort import PLAIN_NATURE, Nature
from kinesic.expressivity.style.style import Expressivity

REST = Hand()
_LEVER = 0.15  # [m/rad] of way that a turn of the hand is worth: forearms turn more slowly than arms swing
_WITHDRAWN = 0.15  # of the way to rest: where the stroke of a form with one key begins
_POINTING_REACH = 0.98  # of the arm's length
_TRAVEL = 0.25  # [arm lengths] of the stroke's way, once, from which on the gesture is dynamic
_ALIKE = 0.1  # [arm lengths] keys nearer than this are one written twice
_GROWN = (1.0, 0.75, 0.5, 0.25, 0.0)  # shares of spatial extent that a path may grow by
_ALONG = np.linspace(0.0, 1.0, 101)
_TARGET_REACH = 0.8  # of the way to a target that is nearer than that
_OWN_OPENNESS = 0.4  # share of an elbow's way that a form may ask for; the rest is the manner's


@dataclass(frozen=True, eq=False)
class Poses:
    """The stroke keys of a behaviour, as hands in the world."""

    hands: Mapping[Side, tuple[Hand, ...]]  # as many keys for each side
    stroke: int  # the key that falls on the sync point `stroke`
    paths: Mapping[Side, tuple[HandPath | None, ...]] = field(default_factory=dict)  # to each key [m], in the world
    again: tuple[int, ...] = ()  # the keys that fall on `stroke:2`, `stroke:3` and so on
    nature: Nature = PLAIN_NATURE  # of the gesture
    body: BodyForm = NO_BODY  # what the rest of the body does
    fingers: FingerMotion | None = None  # what fingers do while the stroke lasts

    @property
    def count(self) -> int:
        """Number of keys."""
        return max((len(row) for row in self.hands.values()), default=0)

    @property
    def times(self) -> int:
        """How often the stroke is done."""
        return 1 + len(self.again)

    def path(self, side: Side, key: int) -> HandPath | None:
        """How a hand comes to a key from the one before; None: straight."""
        return self.paths[side][key] if side in self.paths else None

    def with_effort(self, weight: float) -> "Poses":
        """Gives the gesture so much of its effort profile, 0 to 1."""
        return replace(self, nature=replace(self.nature, weight=weight))

    def only(self, side: Side) -> "Poses":
        """Keeps the keys and paths of one hand alone."""
        paths = {side: self.paths[side]} if side in self.paths else {}
        return replace(self, hands={side: self.hands[side]}, paths=paths)

    def fewer(self) -> "Poses":
        """Removes the last repetition of the stroke."""
        every = (self.stroke, *self.again)
        count = self.count - (every[-1] - every[-2])
        hands = {side: row[:count] for side, row in self.hands.items()}
        paths = {side: row[:count] for side, row in self.paths.items()}
        return replace(self, hands=hands, paths=paths, again=self.again[:-1])


@lru_cache(maxsize=8)
def resting_hands(robot: Robot) -> Mapping[Side, Reach]:
    """Finds where the hands hang, in the world."""
    frames = robot.skeleton.resting
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


def shoulder(robot: Robot, side: Side) -> Floats:
    """Finds the centre of a shoulder, (3,) [m] in the world, at rest."""
    return sealed(robot.skeleton.resting.origins[robot.arm(side).shoulder])


def poses(form: GestureForm, robot: Robot, manner: Expressivity) -> Poses:
    """Puts the stroke keys of a form into the world, under spatial extent, openness and repetition.

    A hand that a key leaves out stays as it was in the key before, at first at rest. A form of one key begins a
    little nearer to rest, so that its stroke shows. Repetition does the stroke up to twice more, below 0 once less
    where the form has it more than once.

    Args:
        form: with at least one key.
        robot: whose space the form is put into.
        manner: of the behaviour.

    Returns:
        For each side that takes part, at least two keys; the middle one of each time is a stroke.
    """
    put = _put_into_world(form.keys, robot, manner)
    more = round(2 * manner.repetition) if manner.repetition > 0 else -round(-manner.repetition)
    times = 1 if form.rest or form.stays else max(1, put.written + more)
    again = tuple(put.count // 2 + k * (put.count - put.back) for k in range(1, times))
    hands = {side: _lift_shoulder(row, put.count // 2, form.body.shoulders) for side, row in put.hands.items()}
    return Poses(
        {side: row + row[put.back :] * (times - 1) for side, row in hands.items()},
        put.count // 2,
        {side: row + row[put.back :] * (times - 1) for side, row in put.paths.items()},
        again,
        Nature(form.category, form.tempo, dynamic=put.travels),
        form.body,
        form.fingers,
    )


@dataclass(frozen=True, eq=False)
class _InWorld:
    """One stroke of a form, in the world."""

    hands: Mapping[Side, tuple[Hand, ...]]
    paths: Mapping[Side, tuple[HandPath | None, ...]]
    count: int  # keys of the stroke, at least two
    written: int  # times that the form has it
    back: int  # 1 where it ends where it begins, else 0
    travels: bool  # whether a hand goes a way of its own


@lru_cache(maxsize=64)  # a gesture is asked for by its durations and by its hands, which differ only in the body's part
def _put_into_world(written: tuple[StrokeKey, ...], robot: Robot, manner: Expressivity) -> _InWorld:
    once, times = _find_repetition(written)
    keys = [widen_key(key, manner.spatial, robot) for key in written[:once]]
    sides = frozenset(side for key in written for side in key.hands)
    hands = {side: _hands_of(keys, side, robot, manner) for side in sides}
    paths = {side: _paths(written[:once], row, side, robot, manner) for side, row in hands.items()}
    travels = _travels(hands, paths, robot)
    if once == 1:
        hands = {side: (withdrawn(hand, robot, side), hand) for side, (hand,) in hands.items()}
        paths = {side: (None, *row) for side, row in paths.items()}
    back = 1 if all(_same_place(row[0], row[-1]) for row in hands.values()) else 0
    return _InWorld(hands, paths, max(once, 2), times, back, travels)


def pointing_poses(target: Floats, side: Side, robot: Robot, shape: str = "index") -> Poses:
    """Points at a place: the wrist on the line from the shoulder, the hand along it.

    Args:
        target: (3,) [m] in the world.
        side: of the hand that points.
        robot: whose arm it is.
        shape: of the hand.
    """
    centre = shoulder(robot, side)
    distance = float(np.linalg.norm(target - centre))
    line = (target - centre) / distance if distance > 0 else np.array([1.0, 0.0, 0.0])
    reach = min(_POINTING_REACH * robot.arm_length, _TARGET_REACH * distance)
    hand = Hand(Reach(sealed(centre + reach * line), pointing=sealed(line)), aim=sealed(target), shape=shape)
    return Poses({side: (withdrawn(hand, robot, side), hand)}, stroke=1, nature=Nature("deictic", dynamic=False))


def withdrawn(hand: Hand, robot: Robot, side: Side) -> Hand:
    """Moves a hand a little nearer to its rest, where it touches nothing."""
    if hand.reach is None:
        return hand
    rest = resting_hands(robot)[side].position
    position = hand.reach.position + _WITHDRAWN * (rest - hand.reach.position)
    return replace(hand, reach=structs.replace(hand.reach, position=sealed(position)), touch=None, tip=None)


def _lift_shoulder(row: tuple[Hand, ...], stroke: int, lift: float) -> tuple[Hand, ...]:
    """Raises the shoulder [rad] above a hand: half before the stroke, and then whole."""
    return tuple(replace(hand, lift=lift if k >= stroke else lift / 2) for k, hand in enumerate(row)) if lift else row


def pose_distance(a: Hand, b: Hand, rest: Reach) -> float:
    """Measures the way between two hand poses [m]: the wrist's, or that of a lever turned with the hand if longer.

    Args:
        a: where it begins.
        b: where it ends.
        rest: how the hand hangs.
    """
    start, end = a.reach or rest, b.reach or rest
    turn = max(angle_between(start.palm, end.palm), angle_between(start.pointing, end.pointing))
    way = start.position - end.position
    return max(sqrt(way @ way), _LEVER * turn)


def _travels(
    hands: Mapping[Side, Sequence[Hand]], paths: Mapping[Side, Sequence[HandPath | None]], robot: Robot
) -> bool:
    """Whether a hand goes a way of its own in the stroke, and does not only come to a pose."""
    for side, row in hands.items():
        places = [(hand.reach or resting_hands(robot)[side]).position for hand in row]
        ways = [
            path.length(a, b) if path else float(np.linalg.norm(b - a))
            for a, b, path in zip(places, places[1:], paths[side][1:], strict=False)
        ]
        if sum(ways) > _TRAVEL * robot.arm_length:
            return True
    return False


def _find_repetition(keys: Sequence[StrokeKey]) -> tuple[int, int]:
    """Finds how many keys make a form that repeats to its end, and how often it is written."""
    for once in range(2, len(keys) // 2 + 1):
        times, left = divmod(len(keys), once)
        if not left and all(_alike(keys[k], keys[k - once]) for k in range(once, len(keys))):
            return once, times
    return len(keys), 1


def _alike(a: StrokeKey, b: StrokeKey) -> bool:
    """Whether two keys have the same hands in the same places, straight from those before."""
    return a.hands.keys() == b.hands.keys() and all(
        pose.path is b.hands[side].path is None
        and float(np.linalg.norm(pose.position - b.hands[side].position)) < _ALIKE
        for side, pose in a.hands.items()
    )


def _same_place(a: Hand, b: Hand) -> bool:
    if a.reach is None or b.reach is None:
        return a.reach is b.reach
    return bool(np.allclose(a.reach.position, b.reach.position, atol=1e-9))


def _paths(
    keys: Sequence[StrokeKey], row: Sequence[Hand], side: Side, robot: Robot, manner: Expressivity
) -> tuple[HandPath | None, ...]:
    """Brings one hand to each of its keys, in the world; amplitude and points follow spatial extent.

    Where a path that grows would leave the arm's easy reach, it grows less.
    """
    centre, easy = shoulder(robot, side), EASY_REACH * robot.arm_length
    found: list[HandPath | None] = []
    for k, key in enumerate(keys):
        pose = key.hands.get(side)
        start, end = row[k - 1].reach, row[k].reach
        if pose is None or pose.path is None or start is None or end is None:
            found.append(None)
            continue
        grown = [_spread_path(pose, pose.path, side, robot, share * manner.spatial) for share in _GROWN]
        farthest = [
            float(np.linalg.norm(p.at(start.position, end.position, _ALONG) - centre, axis=1).max()) for p in grown
        ]
        found.append(next((p for p, far in zip(grown, farthest, strict=True) if far <= easy), grown[-1]))
    return tuple(found)


def _spread_path(pose: HandPose, path: HandPath, side: Side, robot: Robot, spatial: float) -> HandPath:
    """Puts a path under spatial extent into the world."""
    amplitude = robot.arm_length * direction_in_world(side, extend_position(path.amplitude, spatial, pose.fixed))
    return path.mapped(amplitude, lambda point: to_world(robot, side, extend_position(point, spatial, pose.fixed)))


def _hands_of(keys: list[StrokeKey], side: Side, robot: Robot, manner: Expressivity) -> tuple[Hand, ...]:
    """A key without the side repeats the hand before."""
    hands, hand = [], REST
    for key in keys:
        if side in key.hands:
            hand = _in_world(key.hands[side], side, robot, manner)
        hands.append(hand)
    return tuple(hands)


def _in_world(pose: HandPose, side: Side, robot: Robot, manner: Expressivity) -> Hand:
    openness = _OWN_OPENNESS * pose.openness
    return Hand(
        Reach(
            position=to_world(robot, side, pose.position),
            pointing=None if pose.pointing is None else direction_in_world(side, pose.pointing),
            palm=None if pose.palm is None else direction_in_world(side, pose.palm),
        ),
        touch=pose.touch,
        tip=pose.tip,
        openness=openness + (1.0 - openness) * manner.openness,
        effort=max(0.0, manner.power),
        shape=pose.shape,
    )
