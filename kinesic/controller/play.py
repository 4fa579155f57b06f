"""The one loop: a trajectory becomes commands at the ticks of a clock, and sinks follow them."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack

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
    for row in zip(times.tolist(), angles, speeds, accelerations, setpoints.goals, strict=True):
        yield Command(*row)


def play(stream: Iterable[Command], sink: Sink) -> None:
    """Hands every command to the sink, and closes it whatever happens."""
    play_together(((command,) for command in stream), (sink,))


def play_together(stream: Iterable[Sequence[Command]], sinks: Sequence[Sink]) -> None:
    """Hands every tick's commands to their sinks, one each, and closes these whatever happens."""
    with ExitStack() as closing:
        for sink in sinks:
            closing.callback(sink.close)
        for told in stream:
            for sink, command in zip(sinks, told, strict=True):
                sink.write(command)
