"""Random variation of the arms' return paths and rest poses.

On its return, an arm bows outward. Between gestures it hangs a little away from its usual rest pose; at the end of a
block it returns to the usual one.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, radians
from zlib import crc32

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.variation import Variation
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.secondary.arm_times import ArmCourse, Gap
from kinesic.planning.secondary.offset_bumps import OffsetBump

MAX_RETURN_OFFSET = (
    radians(5.0),
    radians(6.0),
    radians(8.0),
)  # [rad] largest return path offsets of shoulder, elbow and wrist
MAX_REST_OFFSET = (radians(4.0), radians(8.0), radians(10.0))  # [rad] largest rest offsets of shoulder, elbow, wrist
FULL_OFFSET_TIME = 0.8  # [s] duration from which a return path gets the full sideways offset
MIN_RETURN_TIME = 0.3  # [s] shorter return paths are not varied
MIN_REST_TIME = 0.2  # [s] shortest rest between gestures whose rest pose is varied
PEAK_FRACTIONS = 0.35, 0.65  # range of the time of the largest offset, as fractions of the path
MAX_REST_DEVIATION = 0.05  # [rad] largest deviation from the rest posture at which an arm counts as hanging
RANGE_MARGIN = 1e-3  # [rad] smallest distance of varied rest poses from the joint limits
LEFT_AXIS = 1  # index of the world axis to the left


def vary_returns(
    courses: Iterable[ArmCourse], motion: Trajectory, variation: Variation, block: str, robot: Robot
) -> Iterator[OffsetBump]:
    """Yield offsets that vary the arms' return paths and rest poses.

    Args:
        courses: of arms through a block.
        motion: through its keys.
        variation: amount and seed.
        block: its id.
        robot: with the arms.
    """
    if variation.amount == 0.0:
        return
    arm_offsets = [one for course in courses for one in _draw_return_offsets(course, motion, variation, block, robot)]
    if arm_offsets:
        yield from turn_outward(arm_offsets, robot)


@dataclass(frozen=True, eq=False)
class ArmOffset:
    """Sideways offset of an arm, with its posture before the offset."""

    bump: OffsetBump
    angles: Floats
    side: Side


def _draw_return_offsets(
    course: ArmCourse, motion: Trajectory, variation: Variation, block: str, robot: Robot
) -> Iterator[ArmOffset]:
    """Yield random offsets of one arm's return paths and rest poses."""
    for stroke, gap in zip(course.strokes, course.gaps[1:], strict=True):
        path, side = gap.return_span, course.side
        if path is None or path[1] - path[0] < MIN_RETURN_TIME:
            continue
        chance = np.random.default_rng((variation.seed, crc32(f"{block}:{stroke.id}:{side}:home".encode())))
        peak = path[0] + float(chance.uniform(*PEAK_FRACTIONS)) * (path[1] - path[0])
        fraction = variation.amount * min(1.0, (path[1] - path[0]) / FULL_OFFSET_TIME)
        there, home = motion.sample(np.array([peak, path[1]]))[0]
        yield ArmOffset(
            OffsetBump(path[0], peak, path[1], draw_offsets(fraction, MAX_RETURN_OFFSET, side, robot, chance)),
            there,
            side,
        )
        if _is_hanging(gap, home, side, robot):  # offset rest pose until the next stroke
            until, offset = gap.rests[-1][1], draw_offsets(variation.amount, MAX_REST_OFFSET, side, robot, chance)
            yield ArmOffset(OffsetBump(path[0], path[1], gap.end, offset, until - path[1]), home, side)


def _is_hanging(gap: Gap, angles: Floats, side: Side, robot: Robot) -> bool:
    """Return whether an arm hangs at rest between two gestures.

    Args:
        gap: after a stroke.
        angles: (n,) [rad] at the end of the return.
        side: of the arm.
        robot: with the arm.
    """
    (there, until), joints = gap.rests[-1], list(robot.arm(side).joints)
    return (
        until < gap.end < inf
        and until - there >= MIN_REST_TIME
        and float(np.abs(angles - robot.skeleton.rest)[joints].max()) <= MAX_REST_DEVIATION
    )


def draw_offsets(
    fraction: float, max_offsets: tuple[float, float, float], side: Side, robot: Robot, chance: np.random.Generator
) -> Floats:
    """Return random angle offsets of the arm's hinges, (n,) [rad]."""
    arm, offsets = robot.arm(side), np.zeros(len(robot.skeleton.hinges))
    hand, forearm = (robot.skeleton.joints_of((name,)) for name in arm.segments[:-3:-1])
    for joint in arm.joints:
        widest = max_offsets[2] if joint in hand else max_offsets[1] if joint in forearm else max_offsets[0]
        offsets[joint] = (
            0.0 if joint in arm.shoulder_lift_joints else fraction * widest * float(chance.uniform(-1.0, 1.0))
        )
    return offsets


def turn_outward(arm_offsets: Sequence[ArmOffset], robot: Robot) -> Iterator[OffsetBump]:
    """Flip offsets that move the hand inwards, and clip to joint ranges."""
    angles, offsets = np.stack([one.angles for one in arm_offsets]), np.stack([one.bump.away for one in arm_offsets])
    wrists = {one.side: robot.arm(one.side).wrist for one in arm_offsets}
    both = robot.skeleton.frames(
        np.stack([angles, angles + offsets]), without=robot.skeleton.segments_off_path(frozenset(wrists.values()))
    )
    for k, one in enumerate(arm_offsets):
        before, after = both.origins[:, k, wrists[one.side], LEFT_AXIS]
        outward = (after - before) * (1.0 if one.side == "l" else -1.0) >= 0.0
        turned = angles[k] + (offsets[k] if outward else -offsets[k])
        inside = np.clip(turned, robot.skeleton.lower + RANGE_MARGIN, robot.skeleton.upper - RANGE_MARGIN)
        yield replace(one.bump, away=np.where(offsets[k] == 0.0, 0.0, inside - angles[k]))
