"""Stream commands to their receivers (sinks) at the ticks of a clock."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import repeat
from time import monotonic, sleep

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import NO_FACE, Command, Sink
from kinesic.body.command import command_times as command_times  # noqa: PLC0414 - deprecated path
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.motion.trajectory import Trajectory


def commands(
    trajectory: Trajectory,
    times: Floats,
    setpoints: FeedForwardSetpoints,
    faces: Sequence[Mapping[str, float]] | None = None,
) -> Iterator[Command]:
    """Yield one planned command per clock tick.

    Args:
        trajectory: of the motion.
        times: (m,) [s] performance time.
        setpoints: of the servos at these times.
        faces: activations of the face at these times; None: no face.
    """
    angles, speeds, accelerations = (sealed(values) for values in trajectory.sample(times))
    shown = repeat(NO_FACE, len(times)) if faces is None else faces
    for row in zip(times.tolist(), angles, speeds, accelerations, setpoints.setpoints, shown, strict=True):
        yield Command(*row)


def pace_commands(stream: Iterable[Command], *, clock: Callable[[], float] = monotonic) -> Iterator[Command]:
    """Yield each command at its time [s] after the iteration begins.

    Late commands follow at once.

    Args:
        stream: in the order of their times.
        clock: returns seconds.
    """
    began = clock()
    for command in stream:
        early = began + command.time - clock()
        if early > 0:
            sleep(early)
        yield command


def play(stream: Iterable[Command], sink: Sink) -> None:
    """Write every command to a receiver (sink), then close the receiver.

    The sink is closed even after an error.
    """
    play_together(((command,) for command in stream), (sink,))


def play_together(stream: Iterable[Sequence[Command]], sinks: Sequence[Sink]) -> None:
    """Write each tick's commands to their receivers, then close the receivers.

    The sinks are closed even after an error.
    """
    with ExitStack() as closing:
        for sink in sinks:
            closing.callback(sink.close)
        for tick in stream:
            for sink, command in zip(sinks, tick, strict=True):
                sink.write(command)
