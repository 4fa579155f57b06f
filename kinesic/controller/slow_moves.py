"""Velocity of the supervisor's own moves near people.

The supervisor moves the robot to rest and to the start of a performance without the planner. It has no model of
contacts, so the velocity of these moves is chosen before it starts.
"""

from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.hardware.supervisor.player import TimedMove
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS, SupervisorSettings
from kinesic.planning.setup import Setup

SAMPLED_MOVES = 1000  # number of random moves, half of which end in the rest posture
STATES_PER_MOVE = 9  # number of instants at which each move is judged
TARGET_RATIO = 0.8  # ratio of force to its limit in the worst sampled move; other moves may have larger ratios
DIFFERENCE_STEP = 1e-3  # [s] step of the finite difference that yields velocities


def settings_near_people(setup: Setup) -> SupervisorSettings:
    """Return supervisor settings whose moves satisfy the policy of contacts.

    Without a policy, these are the default settings. Contact forces are proportional to the velocity.
    """
    if setup.policy is None or setup.impacts is None:
        return DEFAULT_SETTINGS
    ratio = largest_move_ratio(setup, pace=DEFAULT_SETTINGS.pace)
    return replace(DEFAULT_SETTINGS, pace=DEFAULT_SETTINGS.pace * min(1.0, TARGET_RATIO / ratio))


def largest_move_ratio(setup: Setup, *, pace: float, seed: int = 0) -> float:
    """Return the largest contact quantity in random moves / its limit.

    The moves begin in random postures of the whole joint range.

    Args:
        setup: robot with a policy.
        pace: [rad/s] largest joint velocity of the moves.
        seed: seed of the random postures.
    """
    assert setup.policy is not None
    assert setup.impacts is not None
    chance, skeleton = np.random.default_rng(seed), setup.robot.skeleton
    starts, ends = chance.uniform(skeleton.lower, skeleton.upper, (2, SAMPLED_MOVES, len(skeleton.rest)))
    ends[::2] = skeleton.rest
    states = [_sample(TimedMove.between(*posture, pace=pace)) for posture in zip(starts, ends, strict=True)]
    angles, velocities = (np.vstack(values) for values in zip(*states, strict=True))
    return float(setup.impacts.survey(angles, velocities, setup.policy.rows).values.max())


def _sample(move: TimedMove) -> tuple[Floats, Floats]:
    """Return angles and velocities at instants of a move."""
    times = move.duration * np.linspace(0.1, 0.9, STATES_PER_MOVE)
    angles = np.array([move.at(time) for time in times])
    later = np.array([move.at(time + DIFFERENCE_STEP) for time in times])
    return angles, (later - angles) / DIFFERENCE_STEP
