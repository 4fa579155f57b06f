"""Finger motion: angles of the finger drives over a block.

A shape changes during the movement of the arm: the change begins a little after the wrist leaves and is complete when
the stroke begins. Within a stroke and in the retraction, fingers arrive a little after the wrist.
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
from kinesic.expressivity.lexicon.hand_shapes import FINGER_NAMES, Finger, FingerMotion, HandShape, find_shape
from kinesic.expressivity.style.pace import Pace
from kinesic.motion.double_s import least_rest_times

FINGER_DELAY = 0.045  # [s] delay of the fingers after the wrist
CHANGE_TIME = 0.40  # [s] natural duration of a change of the hand shape
MIN_TIME_FACTOR = 1.5  # shortest duration of a shape change / minimum duration of the servos
KEYS_PER_PERIOD = 4  # keys per period of a finger motion
MIN_KEY_INTERVAL = 0.02  # [s] shortest interval between two finger keys
PASSIVE_EXTENSION = 0.7  # extension of a finger without a drive, 0 closed .. 1 straight
EXTENSION_TOLERANCE = 0.35  # largest extension error of a passive finger in a recognisable hand shape


def finger_joints(robot: Robot, side: Side) -> tuple[int, ...]:
    """Return the indices of a hand's finger joints, in joint order."""
    return robot.arm(side).fingers


def shape_angles(shape: HandShape, robot: Robot, side: Side) -> Floats:
    """Convert a hand shape to angles of the finger drives, (f,) [rad].

    Drives are identified by name: flexion, opposition of the thumb, and spread of the fingers (`abduct`). All others
    rest, and so do all drives of a relaxed hand. Fingertips that meet do so on every hand.
    """
    if shape.name == "relaxed":
        return _rest_angles(robot, side)
    angles = _angles(shape.straight, shape.apart, shape.across, robot, side)
    return meeting_angles(angles, shape.meets, robot, side) if shape.meets else angles


def lacking_shapes(names: Iterable[str], robot: Robot) -> tuple[str, ...]:
    """Return the hand shapes that a robot cannot make, unknown names included."""
    return tuple(name for name in names if not _is_possible(name, robot))


@lru_cache(maxsize=512)
def _is_possible(name: str, robot: Robot) -> bool:
    shape = find_shape(name)
    if shape is None:
        return False
    if shape.plain:
        return True
    driven = {name.split("_")[1] for side in SIDES for name in _joint_names(robot, side) if "_flexion" in name}
    present = {finger for side in SIDES for finger in robot.finger_tips(side)} | driven
    extensions = dict(zip(FINGER_NAMES, shape.straight, strict=True))
    return bool(driven) and all(
        finger in driven or _is_dispensable(finger, extensions, present) for finger in FINGER_NAMES
    )


def _is_dispensable(finger: Finger, extensions: Mapping[Finger, float], present: Collection[str]) -> bool:
    """Return whether a hand shape is recognisable without one finger's motion.

    A finger that does not move may rest close to the shape. A finger that the hand lacks is not missed if its neighbour
    has the same position.
    """
    if finger in present:
        return abs(extensions[finger] - PASSIVE_EXTENSION) <= EXTENSION_TOLERANCE
    neighbour = FINGER_NAMES[FINGER_NAMES.index(finger) - 1]
    return finger not in ("thumb", "index") and extensions[finger] == extensions[neighbour]


def finger_keys(
    hands: Mapping[Side, Sequence[HandKey]], works: Sequence[HandStroke], pace: Pace
) -> Mapping[Side, tuple[FingerKey, ...]]:
    """Return the keys of all finger drives over a block.

    Hands without fingers, or with a constant shape, have none.

    Args:
        hands: wrist keys of the hands over the block.
        works: strokes of the hands.
        pace: of the robot.
    """
    keys_by_side: dict[Side, tuple[FingerKey, ...]] = {}
    for side, keys in hands.items():
        if finger_joints(pace.robot, side) and keys:
            busy = [work for work in works if side in work.poses.hands]
            keys_by_side[side] = _add_motions(_changes(keys, busy, side, pace), busy, side, pace)
    return {side: keys for side, keys in keys_by_side.items() if keys}


def _changes(keys: Sequence[HandKey], works: Sequence[HandStroke], side: Side, pace: Pace) -> list[FingerKey]:
    """Return the finger keys of transitions between hand shapes."""
    robot, stroke_starts = pace.robot, [min(work.at("strokeStart"), work.moments[0]) for work in works]
    finger_keys_of_hand: list[FingerKey] = []
    pose_keys = [key for key in keys if not key.hand.passing]
    for before, after in pairwise(pose_keys):
        start_angles, end_angles = (
            _shape_angles_by_name(key.hand.shape or "relaxed", robot, side) for key in (before, after)
        )
        if start_angles is end_angles:
            continue
        minimum = MIN_TIME_FACTOR * _minimum_time(start_angles, end_angles, side, pace)
        enters_stroke = any(abs(after.time - begin) < MIN_KEY_INTERVAL for begin in stroke_starts)
        start = before.time + FINGER_DELAY
        end = max(start + max(minimum, min(CHANGE_TIME, after.time - start)), start + minimum)
        latest = after.time if enters_stroke else after.time + FINGER_DELAY
        if after.hand.shape is not None:
            end = min(end, latest)
        start = min(start, end - minimum)
        if finger_keys_of_hand:
            start = max(start, finger_keys_of_hand[-1].time + MIN_KEY_INTERVAL)
        finger_keys_of_hand += [
            FingerKey(start, start_angles),
            FingerKey(max(end, start + MIN_KEY_INTERVAL), end_angles),
        ]
    return finger_keys_of_hand


def _add_motions(
    changes: list[FingerKey], works: Sequence[HandStroke], side: Side, pace: Pace
) -> tuple[FingerKey, ...]:
    """Add the keys of finger motions during strokes."""
    merged_keys = changes
    for work in works:
        motion = work.poses.fingers
        begin, end = work.at("strokeStart"), work.at("strokeEnd")
        if motion is None or (periods := round((end - begin) * motion.rate)) < 1:
            continue
        shape = find_shape(work.poses.hands[side][work.poses.stroke].shape or "relaxed")
        if shape is None:
            continue
        motion_keys = [
            FingerKey(begin + FINGER_DELAY + (end - begin) * quarter / (KEYS_PER_PERIOD * periods), angles)
            for quarter in range(KEYS_PER_PERIOD * periods + 1)
            for angles in [_motion_angles(shape, motion, quarter, KEYS_PER_PERIOD * periods, pace.robot, side)]
        ]
        first, last = motion_keys[0].time, motion_keys[-1].time
        merged_keys = [key for key in merged_keys if not first - MIN_KEY_INTERVAL < key.time < last + MIN_KEY_INTERVAL]
        merged_keys = sorted([*merged_keys, *motion_keys], key=lambda key: key.time)
    return tuple(merged_keys)


def _motion_angles(shape: HandShape, motion: FingerMotion, quarter: int, last: int, robot: Robot, side: Side) -> Floats:
    """Return finger angles [rad] of a periodic motion after `quarter` quarter periods.

    Each finger leaves the shape and returns to it once per period.
    """

    def fraction(later: float) -> float:
        phase = quarter - later
        return 0.0 if phase <= 0 or quarter == last else (1.0 - np.cos(np.pi / 2 * phase)) / 2

    rows = zip(shape.straight, motion.bend, motion.later, strict=True)
    straight = [min(max(extension - bend * fraction(later), 0.0), 1.0) for extension, bend, later in rows]
    apart = min(max(shape.apart + motion.apart * fraction(0.0), -1.0), 1.0)
    return _angles(straight, apart, shape.across, robot, side)


def _minimum_time(start_angles: Floats, end_angles: Floats, side: Side, pace: Pace) -> float:
    """Return the minimum rest-to-rest duration of the slowest drive [s]."""
    limits = pace.limits.part(np.array(finger_joints(pace.robot, side), dtype=np.intp))
    return float(least_rest_times(end_angles - start_angles, limits).max(initial=0.0))


@lru_cache(maxsize=512)
def _shape_angles_by_name(name: str, robot: Robot, side: Side) -> Floats:
    """Return drive angles [rad] of a hand shape by name or alias.

    All its aliases return the same array.
    """
    shape = find_shape(name)
    canonical = "relaxed" if shape is None else shape.name
    if name != canonical:
        return _shape_angles_by_name(canonical, robot, side)
    return _rest_angles(robot, side) if shape is None else shape_angles(shape, robot, side)


def _rest_angles(robot: Robot, side: Side) -> Floats:
    return sealed(robot.skeleton.rest[list(finger_joints(robot, side))])


def _joint_names(robot: Robot, side: Side) -> list[str]:
    return [robot.skeleton.names[joint] for joint in finger_joints(robot, side)]


def _angles(straight: Sequence[float], apart: float, across: float, robot: Robot, side: Side) -> Floats:
    """Convert finger positions to drive angles, (f,) [rad].

    Positions are fractions between the straight or parallel finger and the ends of its range.
    """
    skeleton, drive_angles = robot.skeleton, []
    for joint, name in zip(finger_joints(robot, side), _joint_names(robot, side), strict=True):
        lower, upper = float(skeleton.lower[joint]), float(skeleton.upper[joint])
        _, finger, axis = name.split("_", maxsplit=2)
        zero = min(max(0.0, lower), upper)
        if axis.startswith("flexion"):
            drive_angles.append(zero + (1.0 - straight[FINGER_NAMES.index(finger)]) * (upper - zero))
        elif axis == "abduct" and finger == "thumb":
            drive_angles.append(_between(lower, zero, upper, across))
        elif axis == "abduct":
            drive_angles.append(_between(lower, zero, upper, apart))
        else:
            drive_angles.append(float(skeleton.rest[joint]))
    return sealed(drive_angles)


def _between(lower: float, zero: float, upper: float, fraction: float) -> float:
    """Interpolate a finger angle: -1 lower limit, 0 zero, 1 upper limit."""
    return zero + (fraction * (upper - zero) if fraction > 0.0 else -fraction * (lower - zero))
