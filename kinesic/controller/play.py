"""Plays a trajectory: commands at the ticks of a clock, and sinks that follow them."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import repeat
from time import monotonic, sleep

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import NO_FACE, RATE, Command, Sink
from kinesic.controller.feedforward import FeedForwardGoals
from kinesic.motion.trajectory import Trajectory

SETTLE = 0.3  # [s] of stillness after the end


def command_times(duration: float, *, rate: float = RATE, settle: float = SETTLE) -> Floats:
    """Returns (m,) [s] performance times of commands, from 0 to the end and a little stillness."""
    return np.arange(int(np.ceil((duration + settle) * rate)) + 1) / rate


def commands(
    trajectory: Trajectory,
    times: Floats,
    setpoints: FeedForwardGoals,
    faces: Sequence[Mapping[str, float]] | None = None,
) -> Iterator[Command]:
    """Yields one command per tick.

    Args:
        trajectory: of the motion.
        times: (m,) [s] performance time.
        setpoints: goals of the servos at these times.
        faces: what the face shows at these times; None: nothing, for sinks that have none.
    """
    angles, speeds, accelerations = (sealed(values) for values in trajectory.sample(times))
    shown = repeat(NO_FACE, len(times)) if faces is None else faces
    for row in zip(times.tolist(), angles, speeds, accelerations, setpoints.goals, shown, strict=True):
        yield Command(*row)


def pace(stream: Iterable[Command], *, clock: Callable[[], float] = monotonic) -> Iterator[Command]:
    """Yields commands at their times on the wall's clock, which begins with the first; late ones follow at once.

    Args:
        stream: in the order of their times.
        clock: seconds that pass.
    """
    began = clock()
    for command in stream:
        early = began + command.time - clock()
        if early > 0:
            sleep(early)
        yield command


def play(stream: Iterable[Command], sink: Sink) -> None:
    """Hands every command to the sink, and closes it whatever happens."""
    play_together(((command,) for command in stream), (sink,))


def play_together(stream: Iterable[Sequence[Command]], sinks: Sequence[Sink]) -> None:
    """Hands every tick's commands to their sinks, one each, and closes these whatever happens."""
    with ExitStack() as closing:
        for sink in sinks:
            closing.callback(sink.close)
        for tick in stream:
            for sink, command in zip(sinks, tick, strict=True):
                sink.write(command)
