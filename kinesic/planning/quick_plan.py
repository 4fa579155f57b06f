"""Quick plans: slow motions with stops at every key.

Durations have closed forms, and paths are quintics. Limits are checked on the spline's control points. A better plan
may replace a quick one while it runs: see `replan`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import sqrt

import numpy as np

from kinesic.bml.block import Block
from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.motion.budget import UNLIMITED_BUDGET, Budget
from kinesic.motion.condition import Conditioned, NearestFinder
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.double_s import IntervalDurations, KeyInterval
from kinesic.motion.key_time_lp import KeyTimeProblem, solve_key_times
from kinesic.motion.keys import Bond, KeyPassage, KeyPosture, Keys
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.segments import SplineSegment
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.certify import MAX_SLOWED_ROUNDS
from kinesic.planning.impact_limits import slow_hinges
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup

PEAK_VELOCITY = 1.875  # peak velocity of a rest-to-rest quintic of unit distance and duration
PEAK_ACCELERATION = 5.7735  # peak acceleration of a rest-to-rest quintic of unit distance and duration
PEAK_JERK = 60.0  # peak jerk of a rest-to-rest quintic of unit distance and duration
DURATION_MARGIN = 1.03  # factor on durations that covers the error of spline approximation
MIN_MOTION_TIME = 0.06  # [s] shortest time between keys of a moving hinge
GAP_GROWTH = 1.1  # factor on all times between keys, applied until the motion is within its limits
STOPPING_PASSAGE = KeyPassage(tension=1.0)  # tension with which a hinge stops at its key


def plan_quickly(block: Block, setup: Setup, *, busy_hands: Sequence[BusyHand] = ()) -> Plan:
    """Plan a block with little computation, stopping at every key.

    Raises:
        BmlError: a `required` behaviour cannot be performed.
    """
    return plan_block(block, setup, conditioned=rest_at_keys, busy_hands=busy_hands)


def rest_at_keys(
    postures: tuple[KeyPosture, ...],
    setup: Setup,
    bonds: tuple[Bond, ...] = (),
    *,
    limit_scale: float = 1.0,
    budget: Budget = UNLIMITED_BUDGET,
    memory: PlaneMemory | None = None,
) -> Conditioned:
    """Return a motion within all limits that stops at every key.

    Under a policy of contacts with people, hinges are slowed until the motion keeps it.

    Args:
        postures: at least two, the first and the last keyed in all hinges.
        setup: limits.
        bonds: between sync points of different behaviours.
        limit_scale: fraction of the limits that is used.
        budget: hardly charged.
        memory: unused.
    """
    limits = setup.limits.scaled(limit_scale)
    motion = _rest_within(limits, postures, bonds, budget)
    for attempt in range(MAX_SLOWED_ROUNDS):
        slowed = slow_hinges(motion.trajectory, limits.speed, setup, attempt)
        if slowed is None:
            break
        limits = replace(limits, speed=slowed)
        motion = _rest_within(limits, postures, bonds, budget)
    return motion


def _rest_within(
    limits: Limits, postures: tuple[KeyPosture, ...], bonds: tuple[Bond, ...], budget: Budget
) -> Conditioned:
    """Return a motion within given limits that stops at every key."""
    keys = Keys.of(postures, limits, bonds)
    gaps, finder = dict(keys.gaps), NearestFinder(keys, limits, _resting)
    for (_, pair), least in _rest_times(keys, limits).items():
        gaps[pair] = max(gaps[pair], least)
    while True:
        budget.spend(len(keys.requested_times))
        times = solve_key_times(KeyTimeProblem(keys, gaps, lead_in=0.0))
        result = finder.find(times)
        if not isinstance(result, SplineSegment):
            break
        gaps = {pair: GAP_GROWTH * gap for pair, gap in gaps.items()}
    motion = Trajectory(sealed(result[1]), -float(times[0]))
    return Conditioned(motion, keys.requested_times, sealed(times), {}, sealed(np.zeros(len(limits.lower))))


def _resting(times: Floats, keys: Keys) -> DesiredMotion:
    """Return a motion that stops at each key, at given times."""
    return join_keys(times, keys.with_passage(STOPPING_PASSAGE))


def _rest_times(keys: Keys, limits: Limits) -> IntervalDurations:
    """Compute each hinge's minimum rest-to-rest time [s] between successive keys."""
    result, hinge_limits = dict[KeyInterval, float](), [_Hinge.of(limits, hinge) for hinge in range(len(limits.lower))]
    for hinge, rows in enumerate(keys.exact_rows):
        angles = keys.angles[rows, hinge].tolist()
        for pair, (before, after) in zip(pairwise(rows), pairwise(angles), strict=True):
            result[hinge, pair] = hinge_limits[hinge].duration(after - before)
    return result


def compute_quintic_duration(travel: float, limits: Limits, hinge: int) -> float:
    """Compute the duration [s] of the shortest rest-to-rest quintic within limits.

    Its duty is bounded by the sum of those of peak velocity and peak acceleration.

    Args:
        travel: [rad].
        limits: of all hinges.
        hinge: index.
    """
    return _Hinge.of(limits, hinge).duration(travel)


@dataclass(frozen=True)
class _Hinge:
    """Limits of one hinge as plain floats, which are faster than arrays."""

    speed: float  # [rad/s] velocity limit
    acceleration: float  # [rad/s^2] acceleration limit
    jerk: float  # [rad/s^3] jerk limit
    inertial: float  # [s^2/rad] duty per acceleration / duty limit
    viscous: float  # [s/rad] duty per velocity / duty limit

    @classmethod
    def of(cls, limits: Limits, hinge: int) -> "_Hinge":
        rows = (limits.speed, limits.acceleration, limits.jerk, limits.inertial, limits.viscous, limits.duty)
        speed, acceleration, jerk, inertial, viscous, duty = (float(row[hinge]) for row in rows)
        return cls(speed, acceleration, jerk, inertial / duty, viscous / duty)

    def duration(self, travel: float) -> float:
        """Compute the shortest rest-to-rest duration [s] of a rotation [rad]."""
        distance = abs(travel)
        if distance == 0.0:
            return 0.0
        velocity_time = max(PEAK_VELOCITY * distance / self.speed, float((PEAK_JERK * distance / self.jerk) ** (1 / 3)))
        acceleration_time = sqrt(PEAK_ACCELERATION * distance / self.acceleration)
        half_drag = self.viscous * PEAK_VELOCITY * distance / 2
        duty_time = half_drag + sqrt(half_drag**2 + self.inertial * PEAK_ACCELERATION * distance)
        return DURATION_MARGIN * max(velocity_time, acceleration_time, duty_time, MIN_MOTION_TIME)
