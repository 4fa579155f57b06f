"""Logs of servo setpoints and measured angles for identification."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.supervisor.channel import Status
from kinesic.sim.log import Log


def select_usable(history: Sequence[Status]) -> tuple[Status, ...]:
    """Return servo statuses with complete finite readings and increasing time."""
    statuses: list[Status] = []
    for status in history:
        if (not statuses or status.time > statuses[-1].time) and np.isfinite(
            [*status.angles, *status.setpoints, *status.taken]
        ).all():
            statuses.append(status)
    return tuple(statuses)


def interpolate_angles(clocks: Floats, taken: Floats, angles: Floats) -> Floats:
    """Interpolate measured angles to the time of each bus cycle.

    Args:
        clocks: (k,) [s] of the cycles.
        taken: (k, n) [s] when each angle was measured.
        angles: (k, n) [rad] measured.

    Returns:
        (k, n) [rad].
    """
    joints = [np.interp(clocks, times, values) for times, values in zip(taken.T, angles.T, strict=True)]
    return sealed(np.transpose(joints).reshape(angles.shape))


def make_servo_log(history: Sequence[Status]) -> Log:
    """Collect sent setpoints and measured angles of each bus cycle.

    The log is empty if no status is usable.
    """
    rows = select_usable(history)
    clocks, setpoints, angles, taken = (
        np.array([getattr(row, name) for row in rows]) for name in ("clock", "setpoints", "angles", "taken")
    )
    begin = clocks[0] if len(rows) else 0.0
    interpolated = interpolate_angles(clocks - begin, taken - begin, angles) if len(rows) else angles
    return Log(sealed(clocks - begin), sealed(setpoints), interpolated)
