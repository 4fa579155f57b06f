"""The one loop: a trajectory becomes commands at the ticks of a clock, and a sink follows them."""

from collections.abc import Iterable, Iterator

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command, Sink
from kinesic.controller.feedforward import Lead
from kinesic.controller.trajectory import Trajectory

RATE = 100  # [Hz] of commands
SETTLE = 0.3  # [s] of stillness after the end


def ticks(duration: float, *, rate: int = RATE, settle: float = SETTLE) -> Floats:
    """(m,) [s] performance times of commands, from 0 to the end and a little stillness."""
    return np.arange(int(np.ceil((duration + settle) * rate)) + 1) / rate


def commands(trajectory: Trajectory, times: Floats, setpoints: Lead) -> Iterator[Command]:
    """One command per tick, at (m,) performance times."""
    angles, speeds, accelerations = (sealed(values) for values in trajectory.sample(times))
    for k, time in enumerate(times):
        yield Command(float(time), angles[k], speeds[k], accelerations[k], setpoints.goals[k])


def play(stream: Iterable[Command], sink: Sink) -> None:
    """Hands every command to the sink, and closes it whatever happens."""
    try:
        for command in stream:
            sink.write(command)
    finally:
        sink.close()
