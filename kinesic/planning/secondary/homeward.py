"""Ways home: no two of them are alike, and hands do not settle twice in the same place.

On its way home an arm bows aside, never towards the body's middle. Where it rests until its next gesture, it hangs
a little beside its usual rest; after the last one of a block it comes to rest as it began.
"""

from collections.abc import Iterable, Iterator
from math import inf, radians
from zlib import crc32

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.variation import Variation
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.secondary.arm_times import ArmCourse, Gap
from kinesic.planning.secondary.swells import Swell

BOW = radians(5.0), radians(6.0), radians(8.0)  # that shoulder, elbow and wrist turn aside on the way home at most
SETTLED = radians(1.5), radians(3.0), radians(4.0)  # likewise where the hand rests until the next gesture
WHOLE = 0.8  # [s] of a way, that is worth a whole bow
LEAST_WAY, LEAST_REST = 0.3, 0.2  # [s]
FARTHEST = 0.35, 0.65  # share of the way, at which the bow is widest
AT_REST = 0.05  # [rad] from rest: the arm hangs
INWARD = 1e-3  # [rad] that hinges keep from the ends of their ranges
LEFT = 1  # axis of the world


def ways_home(
    courses: Iterable[ArmCourse], motion: Trajectory, variation: Variation, block: str, robot: Robot
) -> Iterator[Swell]:
    """Makes ways home, and the places where hands rest, differ.

    Args:
        courses: of arms through a block.
        motion: through its keys.
        variation: how far, and with which seed.
        block: its id.
        robot: whose arms they are.
    """
    if variation.amount == 0.0:
        return
    for course in courses:
        for stroke, gap in zip(course.strokes, course.gaps[1:], strict=True):
            way = gap.way_home
            if way is None or way[1] - way[0] < LEAST_WAY:
                continue
            chance = np.random.default_rng((variation.seed, crc32(f"{block}:{stroke.id}:{course.side}:home".encode())))
            peak = way[0] + float(chance.uniform(*FARTHEST)) * (way[1] - way[0])
            share = variation.amount * min(1.0, (way[1] - way[0]) / WHOLE)
            bow = _aside(share, BOW, motion.at(peak).angles, course.side, robot, chance)
            yield Swell(way[0], peak, way[1], bow)
            yield from _settled(gap, variation.amount, motion.at(way[1]).angles, course.side, robot, chance)


def _settled(
    gap: Gap, amount: float, angles: Floats, side: Side, robot: Robot, chance: np.random.Generator
) -> Iterator[Swell]:
    """Lets a hand hang beside its usual rest until it leaves for its next stroke, where it has its place again."""
    (there, until), joints = gap.rests[-1], list(robot.arm(side).joints)
    if gap.end == inf or until - there < LEAST_REST or np.abs(angles - robot.skeleton.rest)[joints].max() > AT_REST:
        return
    begin = gap.way_home[0] if gap.way_home else there
    yield Swell(begin, there, gap.end, _aside(amount, SETTLED, angles, side, robot, chance), until - there)


def _aside(
    share: float,
    most: tuple[float, float, float],
    angles: Floats,
    side: Side,
    robot: Robot,
    chance: np.random.Generator,
) -> Floats:
    """(n,) [rad] by chance, within the ranges of an arm, and the hand no nearer to the body's middle."""
    arm, away = robot.arm(side), np.zeros(len(angles))
    hand, forearm = (robot.skeleton.joints_of((name,)) for name in arm.segments[:-3:-1])
    for joint in arm.joints:
        widest = most[2] if joint in hand else most[1] if joint in forearm else most[0]
        away[joint] = 0.0 if joint in arm.lifting else share * widest * float(chance.uniform(-1.0, 1.0))
    both = robot.skeleton.frames(np.stack([angles, angles + away]), without=_beside(robot, arm.wrist))
    wrists = both.origins[:, arm.wrist, LEFT]
    outward = (wrists[1] - wrists[0]) * (1.0 if side == "l" else -1.0) >= 0.0
    turned = angles + (away if outward else -away)
    inside = np.clip(turned, robot.skeleton.lower + INWARD, robot.skeleton.upper - INWARD)
    return np.where(away == 0.0, 0.0, inside - angles)


def _beside(robot: Robot, segment: int) -> frozenset[int]:
    """The segments that do not carry a segment."""
    carrying = set()
    while segment >= 0:
        carrying.add(segment)
        segment = robot.skeleton.steps[segment][0]
    return frozenset(range(len(robot.skeleton.segments))) - carrying
