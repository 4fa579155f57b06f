"""The one loop: a trajectory becomes commands at the ticks of a clock, and a sink follows them."""

from collections.abc import Iterable, Iterator

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command, Sink
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.controller.feedforward import goals
from kinesic.controller.trajectory import Trajectory

RATE = 100  # [Hz] of commands
SETTLE = 0.3  # [s] of stillness after the end


def ticks(duration: float, *, rate: int = RATE, settle: float = SETTLE) -> Floats:
    """(m,) [s] performance times of commands, from 0 to the end and a little stillness."""
    return np.arange(int(np.ceil((duration + settle) * rate)) + 1) / rate


def commands(trajectory: Trajectory, times: Floats, robot: Robot, dynamics: Dynamics) -> Iterator[Command]:
    """One command per tick, with feed-forward."""
    angles, speeds, accelerations = (sealed(values) for values in trajectory.sample(times))
    period = float(times[1] - times[0]) if len(times) > 1 else 1 / RATE
    setpoints = sealed(goals(trajectory, times, robot, dynamics, period=period))
    for k, time in enumerate(times):
        yield Command(float(time), angles[k], speeds[k], accelerations[k], setpoints[k])


def play(stream: Iterable[Command], sink: Sink) -> None:
    """Hands every command to the sink, and closes it whatever happens."""
    try:
        for command in stream:
            sink.write(command)
    finally:
        sink.close()
