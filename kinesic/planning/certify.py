"""Conditions a motion under ever tighter limits until inverse dynamics finds no drive beyond its full duty.

The duty row of `condition` takes each hinge for itself, with its worst load. What other hinges add is known only from
the motion: where inverse dynamics finds a drive above its full duty, its row becomes tighter.
"""

from functools import partial

import numpy as np

from kinesic.body.arrays import Floats, Indices, distinct_rows
from kinesic.motion.budget import ENDLESS, Budget
from kinesic.motion.condition import LEAD_IN, Conditioned, condition
from kinesic.motion.keys import Bond, KeyPosture
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.setup import Setup

FULL = 0.995  # of the duty, at the knots: in between it may be a little more
EASE = 0.5  # of the duty, from which no jerk leads to a full one and back to it within two knots
TIGHTER = 0.93  # on the row of a drive above its full duty, beside what it exceeds
ATTEMPTS = 6
KNOTS_PER_WINDOW = 4096  # knots that are looked at together, however long the motion is
SAME = 1e-5  # [rad, rad/s, rad/s^2] knots that differ by less ask for the same torque


def certify(
    keys: tuple[KeyPosture, ...],
    setup: Setup,
    bonds: tuple[Bond, ...] = (),
    *,
    ease: float = 1.0,
    lead_in: float = LEAD_IN,
    budget: Budget = ENDLESS,
    memory: PlaneMemory | None = None,
) -> Conditioned:
    """Conditions the motion through keys so that no drive exceeds its full duty, if that can be.

    Args:
        keys: at least two, the first and the last keyed in all hinges.
        setup: limits and dynamics.
        bonds: between sync points of different behaviours.
        ease: share of the limits with which key times are found.
        lead_in: [s] by which the first key may come earlier.
        budget: for all searches of key times together.
        memory: of what searches for the same block found out.
    """
    search = partial(
        condition, keys, bonds=bonds, ease=ease, lead_in=lead_in, budget=budget, memory=memory or PlaneMemory()
    )
    motion = search(setup.limits)
    share = np.ones(len(setup.limits.duty))
    for attempt in range(ATTEMPTS):
        peaks = duties(motion.trajectory, setup)
        over = peaks > FULL
        if not over.any():
            break
        share[over] *= TIGHTER / peaks[over]
        if attempt >= ATTEMPTS // 2:  # the pull may come from any hinge
            share *= TIGHTER
        motion = search(setup.limits.times(share))
    return motion


def duties(trajectory: Trajectory, setup: Setup) -> Floats:
    """Computes (n,) the largest duty of each drive at the knots of a motion; standing still counts once."""
    times = trajectory.start + np.arange(0.0, trajectory.duration, STEP)
    windows = (
        _duties_at(trajectory, times[k : k + KNOTS_PER_WINDOW], setup)[0]
        for k in range(0, len(times), KNOTS_PER_WINDOW)
    )
    return np.asarray(np.max([duty.max(axis=0) for duty in windows], axis=0))


def overloaded_times(motion: Trajectory, changed: Trajectory, times: Floats, setup: Setup) -> Floats:
    """Finds those of some times (m,) [s] at which a drive is above its full duty that is not as the motion was.

    Jerk is limited, so that a time between two others is not looked at where every drive is at ease at both of them.
    """
    now = _duty_at_each(changed, times[::2], setup)
    easy, count = now.max(axis=1) <= EASE, len(times) // 2
    apart = np.append(times[2::2], np.inf)[:count] - times[::2][:count]
    between = times[1::2][~(easy[:count] & np.append(easy[1:], False)[:count] & (apart < 2.5 * STEP))]
    looked_at = np.append(times[::2], between)
    now = np.vstack([now, _duty_at_each(changed, between, setup)])
    over = np.any(now > FULL, axis=1)
    if not over.any():
        return np.zeros(0)
    before = _duty_at_each(motion, looked_at[over], setup)
    return np.asarray(looked_at[over][np.any(now[over] > np.maximum(FULL, before), axis=1)])


def _duty_at_each(trajectory: Trajectory, times: Floats, setup: Setup) -> Floats:
    """(m, n) duties at (m,) times [s]."""
    found, rows = _duties_at(trajectory, times, setup)
    return np.asarray(found[rows])


def _duties_at(trajectory: Trajectory, times: Floats, setup: Setup) -> tuple[Floats, Indices]:
    """(k, n) duties at those of some times (m,) [s] that differ, and (m,) which of them stands for each."""
    states = trajectory.sample(times)
    chosen, rows = distinct_rows(np.hstack(states), SAME)
    angles, speeds, accelerations = (state[chosen] for state in states)
    torques = setup.dynamics.torques(angles, speeds, accelerations)
    return np.abs(torques / setup.robot.drives.stall + speeds * setup.limits.viscous), rows
