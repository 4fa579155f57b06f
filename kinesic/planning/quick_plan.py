"""Plans a motion that can begin at once: at rest at every key, so slow that no program has to be solved.

Its times come from closed forms, its path from quintics; limits hold by construction and are checked on the control
points. A better plan goes on with it while it runs: see `replan`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt

import numpy as np

from kinesic.bml.block import Block
from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.motion.budget import ENDLESS, Budget
from kinesic.motion.condition import Conditioned, NearestFinder
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.double_s import Gaps, Way
from kinesic.motion.key_time_lp import KeyTimeProblem, relax_key_times
from kinesic.motion.keys import Bond, KeyPassage, KeyPosture, Keys
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.segments import SplineSegment
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup

PEAK_SPEED = 1.875  # of a quintic from rest to rest, in distance / duration
PEAK_ACCELERATION = 5.7735  # in distance / duration^2
PEAK_JERK = 60.0  # in distance / duration^3
RESERVE = 1.03  # on its duration, for what the grid makes of it
LEAST_GAP = 0.06  # [s] of a gap in which something moves
LONGER = 1.1  # on gaps that do not suffice after all
STOPPING = KeyPassage(tension=1.0)  # of every key


def plan_quickly(block: Block, setup: Setup, *, engaged: Sequence[Engaged] = ()) -> Plan:
    """Plans a block so that it can begin at once; nothing of it is late in block zero.

    Raises:
        BmlError: something `required` cannot be performed.
    """
    return plan_block(block, setup, conditioned=rest_at_keys, engaged=engaged)


def rest_at_keys(
    postures: tuple[KeyPosture, ...],
    setup: Setup,
    bonds: tuple[Bond, ...] = (),
    *,
    ease: float = 1.0,
    budget: Budget = ENDLESS,
    memory: PlaneMemory | None = None,
) -> Conditioned:
    """Makes a motion that rests at every key.

    Args:
        postures: at least two, the first and the last keyed in all hinges.
        setup: limits.
        bonds: between sync points of different behaviours.
        ease: share of the limits that is used.
        budget: of which this takes hardly any.
        memory: which this does not need.
    """
    limits = setup.limits.times(ease)
    keys = Keys.of(postures, limits, bonds)
    gaps, finder = dict(keys.gaps), NearestFinder(keys, limits, _resting)
    for (_, pair), least in _rest_times(keys, limits).items():
        gaps[pair] = max(gaps[pair], least)
    while True:
        budget.spend(len(keys.asked))
        times = relax_key_times(KeyTimeProblem(keys, gaps, lead_in=0.0))
        found = finder.find(times)
        if not isinstance(found, SplineSegment):
            break
        gaps = {pair: LONGER * gap for pair, gap in gaps.items()}
    motion = Trajectory(sealed(found[1]), -float(times[0]))
    return Conditioned(motion, keys.asked, sealed(times), {}, sealed(np.zeros(len(limits.lower))))


def _resting(times: Floats, keys: Keys) -> DesiredMotion:
    """The motion that rests at every key."""
    return join_keys(times, keys.passed(STOPPING))


def _rest_times(keys: Keys, limits: Limits) -> Gaps:
    """The `quintic_duration` of every hinge from each of its keys to the next."""
    found, every = dict[Way, float](), [_Hinge.of(limits, hinge) for hinge in range(len(limits.lower))]
    for hinge, own in enumerate(keys.own):
        angles = keys.angles[own, hinge].tolist()
        for pair, (before, after) in zip(pairwise(own), pairwise(angles), strict=True):
            found[hinge, pair] = every[hinge].duration(after - before)
    return found


def quintic_duration(way: float, limits: Limits, hinge: int) -> float:
    """Computes the time [s] of a quintic from rest to rest over a way [rad], within all limits of a hinge.

    Its duty is bounded by that of its greatest speed and its greatest acceleration together.
    """
    return _Hinge.of(limits, hinge).duration(way)


@dataclass(frozen=True)
class _Hinge:
    """The limits of one hinge, as plain numbers: several times faster than arrays of one."""

    speed: float  # [rad/s]
    acceleration: float  # [rad/s^2]
    jerk: float  # [rad/s^3]
    inertial: float  # [s^2/rad] share of the duty per acceleration
    viscous: float  # [s/rad] share of the duty per speed

    @classmethod
    def of(cls, limits: Limits, hinge: int) -> "_Hinge":
        rows = (limits.speed, limits.acceleration, limits.jerk, limits.inertial, limits.viscous, limits.duty)
        speed, acceleration, jerk, inertial, viscous, duty = (float(row[hinge]) for row in rows)
        return cls(speed, acceleration, jerk, inertial / duty, viscous / duty)

    def duration(self, way: float) -> float:
        """What the function of this name computes."""
        size = abs(way)
        if size == 0.0:
            return 0.0
        fast = max(PEAK_SPEED * size / self.speed, float((PEAK_JERK * size / self.jerk) ** (1 / 3)))
        strong = sqrt(PEAK_ACCELERATION * size / self.acceleration)
        half = self.viscous * PEAK_SPEED * size / 2
        loaded = half + sqrt(half**2 + self.inertial * PEAK_ACCELERATION * size)
        return RESERVE * max(fast, strong, loaded, LEAST_GAP)
