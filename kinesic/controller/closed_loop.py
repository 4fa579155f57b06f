"""Performs a whole motion in twins: commands, correction and physics of all ticks in one compiled loop.

Where there is no compiler, or a twin's supply sags, Python does the same tick by tick, and slower.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import RATE, Command
from kinesic.controller.feedforward import FeedForwardGoals
from kinesic.controller.observer import (
    CLEAR_LOAD,
    FORGETTING,
    LARGEST,
    Observer,
    ObserverInputs,
    correct_goals,
    noticing,
)
from kinesic.controller.observer_step import FADING, RESTORING, SHARES
from kinesic.controller.play import commands, play_together
from kinesic.kernels import Kernel, find_kernel
from kinesic.motion.trajectory import Trajectory
from kinesic.sim.stepping.addresses import TwinParts
from kinesic.sim.stepping.step_log import StepRecord
from kinesic.sim.twin import Twin

KERNEL: Kernel = find_kernel("kinesic.controller._kernel")  # which implementation runs

if KERNEL == "compiled":
    from kinesic.controller import _kernel


def perform_in_twins(
    trajectory: Trajectory,
    times: Floats,
    setpoints: FeedForwardGoals,
    twins: Sequence[Twin],
    observers: Callable[[int], Observer] | None,
    progress: Callable[[float], None],
) -> Iterator[Twin]:
    """Performs a motion in twins that were just built, and yields each when it is done and holds what it measured.

    Args:
        trajectory: of the motion.
        times: (m,) [s] performance times of the commands.
        setpoints: goals of the servos at these times.
        twins: each follows for itself.
        observers: makes the observer of so many bodies that corrects the goals; None: nobody does.
        progress: gets the share of the ticks that are over, now and then.
    """
    parts = [twin.parts() for twin in twins] if KERNEL == "compiled" else []
    known = [part for part in parts if part is not None]
    if len(known) < len(twins):
        _perform_tick_by_tick(trajectory, times, setpoints, twins, observers, progress)
        yield from twins
        return
    angles, observer = trajectory.sample(times)[0], observers(1) if observers else None
    inputs = _inputs(observer, angles, setpoints) if observer else np.empty(0)
    for done, (twin, part) in enumerate(zip(twins, known, strict=True)):
        twin.take(_perform(part, times, setpoints.goals, observer, inputs, progress, done, len(twins)))
        if done + 1 == len(twins):
            inputs = np.empty(0)  # as large as all that is measured, and not read any more
        yield twin


def _perform(
    parts: TwinParts,
    times: Floats,
    goals: Floats,
    observer: Observer | None,
    inputs: Floats,
    progress: Callable[[float], None],
    done: int,
    twins: int,
) -> StepRecord:
    """Performs in one twin, after so many of all."""

    def tell(tick: int) -> None:
        progress((done + tick / len(times)) / twins)

    angles, speeds, spans, aimed, counts, sent = _kernel.perform(
        _kernel.make_physics(*(getattr(parts, name) for name in TwinParts.__dataclass_fields__)),
        times,
        goals,
        None if observer is None else _compiled(observer),
        inputs,
        tell,
        RATE,
    )
    size = len(parts.positions)
    return StepRecord(
        times, sent.reshape(goals.shape), counts, aimed, angles.reshape(-1, size), speeds.reshape(-1, size), spans
    )


def _inputs(observer: Observer, angles: Floats, setpoints: FeedForwardGoals) -> Floats:
    """(m, 10, n) what `Observer.inputs` gives for the set points themselves."""
    rows = np.empty((len(angles), len(ObserverInputs.__dataclass_fields__), angles.shape[1]))
    constants = np.array([noticing(observer.period), observer.period / FORGETTING, CLEAR_LOAD, LARGEST])
    led = setpoints.goals, setpoints.loads, setpoints.leads
    _kernel.observer_inputs(angles, *led, observer.arrival, observer.lower, observer.upper, constants, rows)
    return rows


def _compiled(observer: Observer) -> "_kernel.Observer":
    constants = np.array([*(observer.restoring * RESTORING), *SHARES, FADING])
    return _kernel.make_observer(
        observer.forecast, observer.gain, observer.step, observer.full, observer.arrival, constants
    )


def _perform_tick_by_tick(
    trajectory: Trajectory,
    times: Floats,
    setpoints: FeedForwardGoals,
    twins: Sequence[Twin],
    observers: Callable[[int], Observer] | None,
    progress: Callable[[float], None],
) -> None:
    stream = tuple(commands(trajectory, times, setpoints))
    ticks: Iterator[tuple[Command, ...]] = ((command,) * len(twins) for command in stream)
    if observers:
        ticks = correct_goals(stream, setpoints, twins, observers(len(twins)))
    play_together(_counted(ticks, len(stream), progress), twins)


def _counted(
    ticks: Iterator[tuple[Command, ...]], count: int, progress: Callable[[float], None]
) -> Iterator[tuple[Command, ...]]:
    """Passes ticks on, and tells once a second which share of them is over."""
    for k, tick in enumerate(ticks):
        yield tick
        if k % RATE == 0:
            progress(k / count)
