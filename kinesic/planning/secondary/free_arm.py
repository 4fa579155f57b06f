"""Small movements of a resting arm while the other arm gestures."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from math import radians
from types import MappingProxyType
from zlib import crc32

import numpy as np

from kinesic.body.robot import OTHER_SIDE, Robot, Side
from kinesic.expressivity.idle import Span
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.arm_times import ArmCourse, ArmStroke, Gap
from kinesic.planning.secondary.homeward import MAX_REST_DEVIATION, ArmOffset, draw_offsets, turn_outward
from kinesic.planning.secondary.offset_bumps import OffsetBump

MAX_SWING = (radians(3.0), radians(4.0), radians(5.0))  # [rad] largest offsets of shoulder, elbow and wrist
MIN_SWING_TIME = 0.6  # [s] duration of a gesture's hand motion below which the other arm stays still
FULL_SWING_TIME = 1.2  # [s] duration of a gesture's hand motion from which the other arm has its full offset
NO_TIMES: Mapping[Side, Sequence[float]] = MappingProxyType({})  # default: no touch times [s], empty


def swing_free_arms(
    courses: Iterable[ArmCourse],
    motion: Trajectory,
    amount: float,
    robot: Robot,
    *,
    seed: tuple[int, str] = (0, ""),
    touched: Mapping[Side, Sequence[float]] = NO_TIMES,
) -> Iterator[OffsetBump]:
    """Yield a resting arm's offsets during the other arm's gestures.

    A person's free arm follows the trunk a little. It moves away from the body until the end of the stroke, and returns
    with the other hand.

    Args:
        courses: of the arms through a block.
        motion: through its keys.
        amount: 0 none .. 1 like a person.
        robot: with the arms.
        seed: of the random offsets, and id of the block.
        touched: [s] performance times at which the other hand touches this arm.
    """
    if amount == 0.0:
        return
    swings = [swing for course in courses for swing in _draw_swings(course, motion, amount, robot, seed, touched)]
    if swings:
        yield from turn_outward(swings, robot)


def _draw_swings(
    course: ArmCourse,
    motion: Trajectory,
    amount: float,
    robot: Robot,
    seed: tuple[int, str],
    touched: Mapping[Side, Sequence[float]],
) -> Iterator[ArmOffset]:
    """Yield random offsets of the arm that does not perform the strokes."""
    side = OTHER_SIDE[course.side]
    if side not in robot.sides:
        return
    for stroke, (before, after) in zip(course.strokes, pairwise(course.gaps), strict=True):
        begin, end = _find_motion(stroke, before, after, motion)
        if end - begin < MIN_SWING_TIME or not begin < stroke.end < end:
            continue
        if any(begin <= time <= end for time in touched.get(side, ())) or not _rests(motion, (begin, end), side, robot):
            continue
        chance = np.random.default_rng((seed[0], crc32(f"{seed[1]}:{stroke.id}:{side}:free".encode())))
        fraction = amount * min(1.0, (end - begin) / FULL_SWING_TIME)
        offsets = draw_offsets(fraction, MAX_SWING, side, robot, chance)
        angles = motion.sample(np.array([stroke.end]))[0][0]
        yield ArmOffset(OffsetBump(begin, stroke.end, end, offsets), angles, side)


def _find_motion(stroke: ArmStroke, before: Gap, after: Gap, motion: Trajectory) -> Span:
    """Return the time span [s] of a hand's motion around a stroke."""
    begin = before.rests[-1][1] if before.rests else before.begin
    end = after.rests[0][0] if after.rests else after.end
    if after.return_span is not None:
        end = after.return_span[1]
    return max(begin, motion.start), min(end, motion.end)


def _rests(motion: Trajectory, span: Span, side: Side, robot: Robot) -> bool:
    """Return whether an arm holds its rest posture during a time span."""
    joints = list(robot.arm(side).joints)
    first, last = (round((time - motion.start) / KNOT_INTERVAL) for time in span)
    angles = motion.controls[max(first, 0) : last + 1][:, joints]
    return bool(np.abs(angles - robot.skeleton.rest[joints]).max(initial=0.0) <= MAX_REST_DEVIATION)
