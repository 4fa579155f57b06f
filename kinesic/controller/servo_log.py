"""Goals and angles of servos, cycle by cycle, as a log that tells how they are."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.supervisor.channel import Status
from kinesic.sim.log import Log


def usable(history: Sequence[Status]) -> tuple[Status, ...]:
    """Lists the cycles in which time went on and every servo had been read."""
    found: list[Status] = []
    for status in history:
        if (not found or status.time > found[-1].time) and np.isfinite(
            [*status.angles, *status.goals, *status.taken]
        ).all():
            found.append(status)
    return tuple(found)


def angles_at(clocks: Floats, taken: Floats, angles: Floats) -> Floats:
    """(k, n) [rad] as they were at the clocks (k,) [s] of cycles, from those that servos took at times (k, n) [s]."""
    joints = [np.interp(clocks, times, seen) for times, seen in zip(taken.T, angles.T, strict=True)]
    return sealed(np.transpose(joints).reshape(angles.shape))


def log_of_cycles(history: Sequence[Status]) -> Log:
    """Gathers goals sent and angles measured, at the clocks of the cycles; empty where none can be used."""
    rows = usable(history)
    clocks, goals, angles, taken = (
        np.array([getattr(row, name) for row in rows]) for name in ("clock", "goals", "angles", "taken")
    )
    begin = clocks[0] if len(rows) else 0.0
    followed = angles_at(clocks - begin, taken - begin, angles) if len(rows) else angles
    return Log(sealed(clocks - begin), sealed(goals), followed)
