"""Fingers in time: the shape of each hand through a block, as angles of the drives of its fingers.

A shape changes with the arm on its way: it begins a little after the wrist leaves and is complete when the stroke
begins. Within a stroke and on the way home fingers arrive a little after the wrist.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.hands.fingertips import meeting_angles
from kinesic.expressivity.hands.keys import HandKey
from kinesic.expressivity.hands.strokes import HandStroke
from kinesic.expressivity.keyframes import FingerKey
from kinesic.expressivity.lexicon.hand_shapes import FINGERS, Finger, FingerMotion, HandShape, find_shape
from kinesic.expressivity.style.pace import Pace
from kinesic.motion.double_s import least_rest_times

LAG = 0.045  # [s] by which fingers follow the wrist
CHANGE_TIME = 0.40  # [s] that a change takes, where there is time
HASTE = 1.5  # times the shortest time that servos need, which it takes at least
QUARTERS = 4  # keys of a turn of a motion
BREATH = 0.02  # [s] between keys at least
RELAXED = 0.7  # how straight a finger without a drive of its own is
TOLERANCE = 0.35  # by which it may be another, and the shape is still made


def finger_joints(robot: Robot, side: Side) -> tuple[int, ...]:
    """Lists the hinges of a hand's fingers, in joint order."""
    return robot.arm(side).fingers


def shape_angles(shape: HandShape, robot: Robot, side: Side) -> Floats:
    """Turns a shape into angles of the finger drives, (f,) [rad].

    Drives are known by their names: those of flexion, of the thumb's opposition and of the fingers' spread `abduct`.
    Any other one rests, and so do all of a relaxed hand. Tips that meet do so on every hand.
    """
    if shape.name == "relaxed":
        return _rest(robot, side)
    angles = _angles(shape.straight, shape.apart, shape.across, robot, side)
    return meeting_angles(angles, shape.meets, robot, side) if shape.meets else angles


def lacking_shapes(names: Iterable[str], robot: Robot) -> tuple[str, ...]:
    """Finds the shapes that the hands of a robot cannot make; a shape that nobody knows is one of them."""
    return tuple(name for name in names if not _can_make(name, robot))


@lru_cache(maxsize=512)
def _can_make(name: str, robot: Robot) -> bool:
    shape = find_shape(name)
    if shape is None:
        return False
    if shape.plain:
        return True
    moved = {name.split("_")[1] for side in SIDES for name in _names(robot, side) if "_flexion" in name}
    there = {finger for side in SIDES for finger in robot.finger_tips(side)} | moved
    asked = dict(zip(FINGERS, shape.straight, strict=True))
    return bool(moved) and all(finger in moved or _may_miss(finger, asked, there) for finger in FINGERS)


def _may_miss(finger: Finger, asked: Mapping[Finger, float], there: Collection[str]) -> bool:
    """Whether a shape is made although a finger does not move: it rests about so; or there is none, nor is it missed.

    A finger that a hand lacks is not missed where its neighbour does the same.
    """
    if finger in there:
        return abs(asked[finger] - RELAXED) <= TOLERANCE
    neighbour = FINGERS[FINGERS.index(finger) - 1]
    return finger not in ("thumb", "index") and asked[finger] == asked[neighbour]


def finger_keys(
    hands: Mapping[Side, Sequence[HandKey]], works: Sequence[HandStroke], pace: Pace
) -> Mapping[Side, tuple[FingerKey, ...]]:
    """Makes the keys of the fingers of both hands; none of a hand that has none, or never changes its shape.

    Args:
        hands: the keys of the hands through a block.
        works: what they do.
        pace: of the robot.
    """
    found: dict[Side, tuple[FingerKey, ...]] = {}
    for side, keys in hands.items():
        if finger_joints(pace.robot, side) and keys:
            busy = [work for work in works if side in work.poses.hands]
            found[side] = _with_motions(_changes(keys, busy, side, pace), busy, side, pace)
    return {side: keys for side, keys in found.items() if keys}


def _changes(keys: Sequence[HandKey], works: Sequence[HandStroke], side: Side, pace: Pace) -> list[FingerKey]:
    """From shape to shape."""
    robot, begins = pace.robot, [min(work.at("strokeStart"), work.moments[0]) for work in works]
    found: list[FingerKey] = []
    posed = [key for key in keys if not key.hand.passing]
    for before, after in pairwise(posed):
        here, there = (_named(key.hand.shape or "relaxed", robot, side) for key in (before, after))
        if here is there:
            continue
        least = HASTE * _least_time(here, there, side, pace)
        entering = any(abs(after.time - begin) < BREATH for begin in begins)
        start = before.time + LAG
        end = max(start + max(least, min(CHANGE_TIME, after.time - start)), start + least)
        latest = after.time if entering else after.time + LAG
        if after.hand.shape is not None:
            end = min(end, latest)
        start = min(start, end - least)
        if found:
            start = max(start, found[-1].time + BREATH)
        found += [FingerKey(start, here), FingerKey(max(end, start + BREATH), there)]
    return found


def _with_motions(
    changes: list[FingerKey], works: Sequence[HandStroke], side: Side, pace: Pace
) -> tuple[FingerKey, ...]:
    """Adds what fingers do while strokes last."""
    found = changes
    for work in works:
        motion = work.poses.fingers
        begin, end = work.at("strokeStart"), work.at("strokeEnd")
        if motion is None or (turns := round((end - begin) * motion.rate)) < 1:
            continue
        shape = find_shape(work.poses.hands[side][work.poses.stroke].shape or "relaxed")
        if shape is None:
            continue
        between = [
            FingerKey(begin + LAG + (end - begin) * quarter / (QUARTERS * turns), angles)
            for quarter in range(QUARTERS * turns + 1)
            for angles in [_moved(shape, motion, quarter, QUARTERS * turns, pace.robot, side)]
        ]
        first, last = between[0].time, between[-1].time
        found = [key for key in found if not first - BREATH < key.time < last + BREATH]
        found = sorted([*found, *between], key=lambda key: key.time)
    return tuple(found)


def _moved(shape: HandShape, motion: FingerMotion, quarter: int, last: int, robot: Robot, side: Side) -> Floats:
    """A shape in a quarter of a motion: each finger goes once in a turn, from the shape and back to it."""

    def share(later: float) -> float:
        phase = quarter - later
        return 0.0 if phase <= 0 or quarter == last else (1.0 - np.cos(np.pi / 2 * phase)) / 2

    rows = zip(shape.straight, motion.bend, motion.later, strict=True)
    straight = [min(max(own - bend * share(later), 0.0), 1.0) for own, bend, later in rows]
    apart = min(max(shape.apart + motion.apart * share(0.0), -1.0), 1.0)
    return _angles(straight, apart, shape.across, robot, side)


def _least_time(here: Floats, there: Floats, side: Side, pace: Pace) -> float:
    """[s] from rest to rest, of the drive that takes longest."""
    limits = pace.limits.part(np.array(finger_joints(pace.robot, side), dtype=np.intp))
    return float(least_rest_times(there - here, limits).max(initial=0.0))


@lru_cache(maxsize=512)
def _named(name: str, robot: Robot, side: Side) -> Floats:
    """The same array for one shape under all its names."""
    shape = find_shape(name)
    canonical = "relaxed" if shape is None else shape.name
    if name != canonical:
        return _named(canonical, robot, side)
    return _rest(robot, side) if shape is None else shape_angles(shape, robot, side)


def _rest(robot: Robot, side: Side) -> Floats:
    return sealed(robot.skeleton.rest[list(finger_joints(robot, side))])


def _names(robot: Robot, side: Side) -> list[str]:
    return [robot.skeleton.names[joint] for joint in finger_joints(robot, side)]


def _angles(straight: Sequence[float], apart: float, across: float, robot: Robot, side: Side) -> Floats:
    """(f,) [rad]; shares go from where a finger is straight, or side by side with others, to the ends of the range."""
    skeleton, found = robot.skeleton, []
    for joint, name in zip(finger_joints(robot, side), _names(robot, side), strict=True):
        lower, upper = float(skeleton.lower[joint]), float(skeleton.upper[joint])
        _, finger, turn = name.split("_", maxsplit=2)
        zero = min(max(0.0, lower), upper)
        if turn.startswith("flexion"):
            found.append(zero + (1.0 - straight[FINGERS.index(finger)]) * (upper - zero))
        elif turn == "abduct" and finger == "thumb":
            found.append(lower + across * (upper - lower))
        elif turn == "abduct":
            found.append(zero + (apart * (upper - zero) if apart > 0.0 else -apart * (lower - zero)))
        else:
            found.append(float(skeleton.rest[joint]))
    return sealed(found)
