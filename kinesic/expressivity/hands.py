"""Hands in the world: where they rest, where the poses of a form are, and what lies between two of them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import radians

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.space import direction_in_world, to_world, widened
from kinesic.expressivity.style import Style

REST = Hand()
_WITHDRAWN = 0.15  # of the way to rest: where the stroke of a form with one key begins
_POINTING_REACH = 0.98  # of the arm's length
_TARGET_REACH = 0.8  # of the way to a target that is nearer than that
_LEAST_SWIVEL, _SWIVEL_RANGE = radians(15), radians(60)


@dataclass(frozen=True, eq=False)
class Poses:
    """The stroke keys of a behaviour, as hands in the world."""

    hands: Mapping[Side, tuple[Hand, ...]]  # as many keys for each side
    stroke: int  # the key that falls on the sync point `stroke`

    @property
    def count(self) -> int:
        """Number of keys."""
        return max((len(row) for row in self.hands.values()), default=0)


def resting(robot: Robot) -> Mapping[Side, Reach]:
    """Where the hands hang, in the world."""
    frames = robot.skeleton.resting
    reaches: dict[Side, Reach] = {}
    for side in SIDES:
        palm = robot.sites[f"{side}_palm"]
        k = robot.skeleton.segment(palm.segment)
        rotation = frames.rotations[k]
        along = rotation @ palm.position
        reaches[side] = Reach(
            position=sealed(frames.origins[k]),
            pointing=sealed(along / np.linalg.norm(along)),
            palm=sealed(rotation @ palm.facing),
        )
    return reaches


def shoulder(robot: Robot, side: Side) -> Floats:
    """(3,) [m] centre of a shoulder in the world, at rest."""
    frames = robot.skeleton.resting
    return sealed(frames.origins[robot.skeleton.segment(robot.chains[f"{side}_arm"][-3])])


def poses(form: GestureForm, robot: Robot, style: Style) -> Poses:
    """The stroke keys of a form as hands in the world, under spatial extent, openness and repetition.

    A hand that a key leaves out stays as it was in the key before, at first at rest. A form of one key begins a
    little nearer to rest, so that its stroke shows; repetition above 0.25 does the stroke once or twice more.

    Args:
        form: with at least one key.
        robot: whose space the form is put into.
        style: of the behaviour.

    Returns:
        For each side that takes part, at least two keys; the middle one of the first time is the stroke.
    """
    keys = [widened(key, style.spatial) for key in form.keys]
    hands = {side: _carried(keys, side, robot, style) for side in form.sides}
    if len(keys) == 1:
        hands = {side: (withdrawn(hand, robot, side), hand) for side, (hand,) in hands.items()}
    times = 1 if form.rest else 1 + round(2 * max(0.0, style.repetition))
    stroke = max(len(keys), 2) // 2
    return Poses({side: row * times for side, row in hands.items()}, stroke)


def pointing_poses(target: Floats, side: Side, robot: Robot) -> Poses:
    """Stroke keys of pointing at a place: the wrist on the line from the shoulder, the hand along it.

    Args:
        target: (3,) [m] in the world.
        side: of the hand that points.
        robot: whose arm it is.
    """
    centre = shoulder(robot, side)
    distance = float(np.linalg.norm(target - centre))
    line = (target - centre) / distance if distance > 0 else np.array([1.0, 0.0, 0.0])
    reach = min(_POINTING_REACH * robot.arm_length, _TARGET_REACH * distance)
    hand = Hand(Reach(sealed(centre + reach * line), pointing=sealed(line)), aim=sealed(target))
    return Poses({side: (withdrawn(hand, robot, side), hand)}, stroke=1)


def withdrawn(hand: Hand, robot: Robot, side: Side) -> Hand:
    """The same hand a little nearer to its rest, where it touches nothing."""
    if hand.reach is None:
        return hand
    rest = resting(robot)[side].position
    position = hand.reach.position + _WITHDRAWN * (rest - hand.reach.position)
    return replace(hand, reach=structs.replace(hand.reach, position=sealed(position)), touch=None)


def distance(a: Hand, b: Hand, rest: Reach) -> float:
    """Way of the wrist from one hand to another [m]; `rest` is where the hand hangs."""
    return float(np.linalg.norm((a.reach or rest).position - (b.reach or rest).position))


def between(a: Hand, b: Hand, share: float, rest: Reach) -> Hand:
    """The hand at a share of the way from one hand to another.

    Args:
        a: at share 0.
        b: at share 1.
        share: 0..1.
        rest: where the hand hangs.

    Returns:
        At rest if both are. What only one of the two asks for holds on its half of the way.
    """
    if a.reach is None and b.reach is None:
        return REST
    if share <= 0 or share >= 1:
        return a if share <= 0 else b
    start, end, nearest = a.reach or rest, b.reach or rest, a if share < 0.5 else b
    reach = nearest.reach or rest
    return Hand(
        Reach(
            position=sealed(start.position + share * (end.position - start.position)),
            pointing=_turned(start.pointing, end.pointing, share, reach.pointing),
            palm=_turned(start.palm, end.palm, share, reach.palm),
            swivel=_mixed(start.swivel, end.swivel, share, reach.swivel),
        ),
        nearest.aim,
        a.touch if a.touch == b.touch else None,
    )


def _carried(keys: list[StrokeKey], side: Side, robot: Robot, style: Style) -> tuple[Hand, ...]:
    """One side of all keys; a key without it repeats the hand before."""
    hands, hand = [], REST
    for key in keys:
        if side in key.hands:
            hand = _in_world(key.hands[side], side, robot, style)
        hands.append(hand)
    return tuple(hands)


def _in_world(pose: HandPose, side: Side, robot: Robot, style: Style) -> Hand:
    openness = min(max(pose.openness + style.openness, 0.0), 1.0)
    return Hand(
        Reach(
            position=to_world(robot, side, pose.position),
            pointing=None if pose.pointing is None else direction_in_world(side, pose.pointing),
            palm=None if pose.palm is None else direction_in_world(side, pose.palm),
            swivel=_LEAST_SWIVEL + _SWIVEL_RANGE * openness if openness > 0 else None,
        ),
        touch=pose.touch,
    )


def _turned(a: Floats | None, b: Floats | None, share: float, nearest: Floats | None) -> Floats | None:
    """Direction on the great circle from one to another; the nearest where one is missing or they are opposite."""
    if a is None or b is None:
        return nearest
    angle = float(np.arccos(np.clip(a @ b, -1.0, 1.0)))
    if angle < 1e-9 or angle > np.pi - 1e-6:
        return nearest
    mixed = (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)
    return sealed(mixed / np.linalg.norm(mixed))


def _mixed(a: float | None, b: float | None, share: float, nearest: float | None) -> float | None:
    return nearest if a is None or b is None else a + share * (b - a)
