"""Plans a motion that can begin at once: at rest at every key, so slow that no program has to be solved.

Its times come from closed forms, its path from quintics; limits hold by construction and are checked on the control
points. A better plan goes on with it while it runs: see `replan`.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from kinesic.bml.block import Block
from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.motion.bspline import grid
from kinesic.motion.budget import ENDLESS, Budget
from kinesic.motion.condition import Conditioned
from kinesic.motion.desired import join_keys
from kinesic.motion.key_time_lp import KeyTimeProblem, relax_key_times
from kinesic.motion.keys import Bond, KeyPosture, Keys, Passage
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.segments import pieces, segments
from kinesic.motion.spline_program import nearest_motion
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup

PEAK_SPEED = 1.875  # of a quintic from rest to rest, in distance / duration
PEAK_ACCELERATION = 5.7735  # in distance / duration^2
PEAK_JERK = 60.0  # in distance / duration^3
RESERVE = 1.03  # on its duration, for what the grid makes of it
LEAST_GAP = 0.06  # [s] of a gap in which something moves
LONGER = 1.1  # on gaps that do not suffice after all
STOPPING = Passage(tension=1.0)  # of every key


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
    gaps = dict(keys.gaps)
    for hinge, own in enumerate(keys.own):
        for i, j in pairwise(own):
            way = float(keys.angles[j, hinge] - keys.angles[i, hinge])
            gaps[i, j] = max(gaps[i, j], duration(way, limits, hinge))
    motion = None
    while motion is None:
        budget.spend(len(keys.asked))
        times = relax_key_times(KeyTimeProblem(keys, gaps, lead_in=0.0))
        motion = _stepwise(times, keys, limits)
        gaps = {pair: LONGER * gap for pair, gap in gaps.items()}
    return Conditioned(motion, keys.asked, sealed(times), {}, sealed(np.zeros(len(limits.lower))))


def duration(way: float, limits: Limits, hinge: int) -> float:
    """Computes the time [s] of a quintic from rest to rest over a way [rad], within all limits of a hinge.

    Its duty is bounded by that of its greatest speed and its greatest acceleration together.
    """
    size = abs(way)
    if size == 0.0:
        return 0.0
    inertial, viscous = limits.inertial[hinge] / limits.duty[hinge], limits.viscous[hinge] / limits.duty[hinge]
    fast = max(PEAK_SPEED * size / limits.speed[hinge], (PEAK_JERK * size / limits.jerk[hinge]) ** (1 / 3))
    strong = np.sqrt(PEAK_ACCELERATION * size / limits.acceleration[hinge])
    half = viscous * PEAK_SPEED * size / 2
    loaded = half + np.sqrt(half**2 + inertial * PEAK_ACCELERATION * size)
    return float(RESERVE * max(fast, strong, loaded, LEAST_GAP))


def _stepwise(times: Floats, keys: Keys, limits: Limits) -> Trajectory | None:
    """Quintics on the grid; None where one exceeds a limit after all."""
    count = pieces(times, STEP)
    desired = join_keys(times, keys.passed(STOPPING)).angles(grid(count, STEP).knots)
    controls = np.empty((count + 3, keys.angles.shape[1]))
    for segment in segments(times, keys, STEP):
        found = nearest_motion(segment, desired[segment.knots, segment.hinge], limits)
        if found is None:
            return None
        controls[segment.controls, segment.hinge] = found
    return Trajectory(sealed(controls), -float(times[0]))
