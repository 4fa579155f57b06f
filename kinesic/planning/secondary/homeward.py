"""Ways home: no two of them are alike, and hands do not settle twice in the same place.

On its way home an arm bows aside, never towards the body's middle. Where it rests until its next gesture, it hangs
a little beside its usual rest; after the last one of a block it comes to rest as it began.
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
from kinesic.planning.secondary.swells import Swell

BOW = radians(5.0), radians(6.0), radians(8.0)  # that shoulder, elbow and wrist turn aside on the way home at most
SETTLED = radians(1.5), radians(3.0), radians(4.0)  # likewise where the hand rests until the next gesture
WHOLE_BOW = 0.8  # [s] of a way, that is worth a whole bow
LEAST_WAY, LEAST_REST = 0.3, 0.2  # [s]
WIDEST_AT = 0.35, 0.65  # share of the way, at which the bow is widest
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
    bends = [bend for course in courses for bend in _bends(course, motion, variation, block, robot)]
    if bends:
        yield from _outward(bends, robot)


@dataclass(frozen=True, eq=False)
class _Bend:
    """A swell that turns an arm aside, and the angles (n,) [rad] that the arm has at its peak without it."""

    swell: Swell
    angles: Floats
    side: Side


def _bends(course: ArmCourse, motion: Trajectory, variation: Variation, block: str, robot: Robot) -> Iterator[_Bend]:
    """Yields the bends of one arm's ways home, each to a side and as far as chance has it."""
    for stroke, gap in zip(course.strokes, course.gaps[1:], strict=True):
        way, side = gap.way_home, course.side
        if way is None or way[1] - way[0] < LEAST_WAY:
            continue
        chance = np.random.default_rng((variation.seed, crc32(f"{block}:{stroke.id}:{side}:home".encode())))
        peak = way[0] + float(chance.uniform(*WIDEST_AT)) * (way[1] - way[0])
        share = variation.amount * min(1.0, (way[1] - way[0]) / WHOLE_BOW)
        there, home = motion.sample(np.array([peak, way[1]]))[0]
        yield _Bend(Swell(way[0], peak, way[1], _aside(share, BOW, side, robot, chance)), there, side)
        if _hangs(gap, home, side, robot):  # beside its usual rest until its next stroke, where it has its place again
            until, aside = gap.rests[-1][1], _aside(variation.amount, SETTLED, side, robot, chance)
            yield _Bend(Swell(way[0], way[1], gap.end, aside, until - way[1]), home, side)


def _hangs(gap: Gap, angles: Floats, side: Side, robot: Robot) -> bool:
    """Whether a hand hangs for a while after a way home to (n,) [rad], until it leaves for its next stroke."""
    (there, until), joints = gap.rests[-1], list(robot.arm(side).joints)
    return (
        gap.end < inf
        and until - there >= LEAST_REST
        and float(np.abs(angles - robot.skeleton.rest)[joints].max()) <= AT_REST
    )


def _aside(
    share: float, most: tuple[float, float, float], side: Side, robot: Robot, chance: np.random.Generator
) -> Floats:
    """(n,) [rad] by chance."""
    arm, away = robot.arm(side), np.zeros(len(robot.skeleton.hinges))
    hand, forearm = (robot.skeleton.joints_of((name,)) for name in arm.segments[:-3:-1])
    for joint in arm.joints:
        widest = most[2] if joint in hand else most[1] if joint in forearm else most[0]
        away[joint] = 0.0 if joint in arm.lifting else share * widest * float(chance.uniform(-1.0, 1.0))
    return away


def _outward(bends: Sequence[_Bend], robot: Robot) -> Iterator[Swell]:
    """Yields the swells of bends, turned away from the body's middle and cut at the ranges of the arms."""
    angles, away = np.stack([bend.angles for bend in bends]), np.stack([bend.swell.away for bend in bends])
    wrists = {bend.side: robot.arm(bend.side).wrist for bend in bends}
    both = robot.skeleton.frames(
        np.stack([angles, angles + away]), without=robot.skeleton.beside(frozenset(wrists.values()))
    )
    for k, bend in enumerate(bends):
        before, after = both.origins[:, k, wrists[bend.side], LEFT]
        outward = (after - before) * (1.0 if bend.side == "l" else -1.0) >= 0.0
        turned = angles[k] + (away[k] if outward else -away[k])
        inside = np.clip(turned, robot.skeleton.lower + INWARD, robot.skeleton.upper - INWARD)
        yield replace(bend.swell, away=np.where(away[k] == 0.0, 0.0, inside - angles[k]))
