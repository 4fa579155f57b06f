"""Polling of servos without torque while a person moves the robot."""

from collections.abc import Iterator

import numpy as np

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes, Snapshot

FIRST_ANSWER_TIMEOUT = 2.0  # [s] time limit for the first answer of every servo
FIRST_ANSWER_PERIOD = 0.05  # [s] time between two snapshots until every servo has answered


def require_torque_off(axes: Axes) -> Snapshot:
    """Wait until all servos have answered, and refuse servos with torque on.

    Raises:
        BusError: a servo has torque, or does not answer.
    """
    for snapshot in poll_servos(axes, FIRST_ANSWER_TIMEOUT, period=FIRST_ANSWER_PERIOD):
        energised = [axes.label(k) for k in np.flatnonzero(snapshot.torque).tolist()]
        if energised:
            raise BusError(
                f"{energised[0]}: has torque, as have {len(energised) - 1} others; "
                "switch it off with `kinesic servos release`"
            )
        if snapshot.recent.all():
            return snapshot
    raise BusError("not all servos answer; run `kinesic servos doctor` to find the cause")


def poll_servos(axes: Axes, seconds: float, *, period: float) -> Iterator[Snapshot]:
    """Yield snapshots of all servos every `period` [s] for a duration [s]."""
    end = axes.now() + seconds
    while axes.now() <= end:
        snapshot = axes.cycle(None)
        yield snapshot
        axes.sleep(snapshot.time + period)
