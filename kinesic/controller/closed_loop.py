"""Performs a motion in twins: commands, correction and physics of all ticks in one compiled loop.

It goes on window by window, so that what a long motion leaves can be measured and let go on the way. Where there is no
compiler, or a twin's supply sags, Python does the same tick by tick, and slower, all in one window.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import RATE, Command
from kinesic.controller.feedforward import FeedForwardGoals
from kinesic.controller.observer import (
    CLEAR_LOAD,
    FORGETTING,
    LARGEST_CORRECTION,
    Observer,
    correct_goals,
    noticing,
)
from kinesic.controller.observer_step import FADING, RESTORING, SHARES
from kinesic.controller.play import commands, play_together
from kinesic.kernels import Kernel, find_kernel
from kinesic.motion.trajectory import Trajectory
from kinesic.sim.stepping.addresses import TwinParts
from kinesic.sim.stepping.friction_step import FrictionParts
from kinesic.sim.stepping.step_log import StepRecord
from kinesic.sim.twin import Twin

KERNEL: Kernel = find_kernel("kinesic.controller._kernel")  # which implementation runs

if KERNEL == "compiled":
    from kinesic.controller import _kernel


COMMANDS_PER_WINDOW = 2048  # commands that are performed before anybody looks: their steps stay in the cache

Lead = Callable[[Floats], FeedForwardGoals]  # set points for goals that are sent at (m,) [s]


@dataclass(frozen=True, eq=False)
class Stretch:
    """Some commands that one of several twins has just performed."""

    twin: int
    commands: slice  # which of all
    setpoints: FeedForwardGoals  # of these


def perform_in_twins(
    trajectory: Trajectory,
    times: Floats,
    lead: Lead,
    twins: Sequence[Twin],
    observers: Callable[[int], Observer] | None,
    progress: Callable[[float], None],
) -> Iterator[Stretch]:
    """Performs a motion in twins that were just built, and yields after every window of each.

    Whoever has it measured window by window calls the twin's `record` before the next one.

    Args:
        trajectory: of the motion.
        times: (m,) [s] performance times of the commands.
        lead: the servos' goals.
        twins: each follows for itself.
        observers: makes the observer of so many bodies that corrects the goals; None: nobody does.
        progress: gets the share of the ticks that are over, now and then.

    Yields:
        Which twin has performed which commands.

    Raises:
        ValueError: times decrease, or are none.
    """
    parts = [twin.parts() for twin in twins] if KERNEL == "compiled" else []
    known = [part for part in parts if part is not None]
    if len(known) < len(twins):
        setpoints = lead(times)
        _perform_tick_by_tick(trajectory, times, setpoints, twins, observers, progress)
        yield from (Stretch(k, slice(0, len(times)), setpoints) for k in range(len(twins)))
        return
    observer = observers(1) if observers else None
    loops = [CompiledLoop(twin, part, observer) for twin, part in zip(twins, known, strict=True)]
    for begin in range(0, len(times), COMMANDS_PER_WINDOW):
        rows = slice(begin, min(begin + COMMANDS_PER_WINDOW, len(times)))
        setpoints = lead(times[rows])
        angles = trajectory.angles(times[rows]) if observer else setpoints.goals
        for k, loop in enumerate(loops):
            done = begin + k * (rows.stop - begin) / len(loops)
            loop.perform(times[rows], angles, setpoints, partial(_tell, progress, done, len(loops), len(times)))
            yield Stretch(k, rows, setpoints)


def _tell(progress: Callable[[float], None], done: float, loops: int, ticks: int, tick: int) -> None:
    """Tells the share of all ticks that are over when one of some loops is at a tick of its window."""
    progress((done + tick / loops) / ticks)


class CompiledLoop:
    """The loop of one twin, which goes on where it was."""

    def __init__(self, twin: Twin, parts: TwinParts, observer: Observer | None) -> None:
        """Begins before the first command.

        Args:
            twin: that was just built.
            parts: of its physics.
            observer: of one body, which corrects its goals; None: nobody does.
        """
        self._twin, self._size = twin, len(parts.positions)
        self._physics = _kernel.make_physics(*(getattr(parts, name) for name in TwinParts.__dataclass_fields__))
        if stages := twin.friction_parts():
            _kernel.split_steps(self._physics, *(getattr(stages, name) for name in FrictionParts.__dataclass_fields__))
        self._correction = None if observer is None else _correction(observer)
        self._under_way = np.empty((0, len(parts.hinges)))  # (w, n) [rad] goals that are sent but not yet in force

    def perform(self, times: Floats, angles: Floats, setpoints: FeedForwardGoals, tell: Callable[[int], None]) -> None:
        """Performs commands at (m,) times [s], with the reference (m, n) [rad], and hands the twin what it did."""
        led = angles, setpoints.goals, setpoints.loads, setpoints.leads
        postures, speeds, spans, aimed, counts, sent = _kernel.perform(
            self._physics, times, led, self._correction, tell, RATE
        )
        goals = sent.reshape(angles.shape)
        coming = np.concatenate([self._under_way, goals])
        aims, self._under_way = coming[: len(aimed)], coming[len(aimed) :].copy()
        postures, speeds = postures.reshape(-1, self._size), speeds.reshape(-1, self._size)
        self._twin.take(StepRecord(times, goals, counts, aims, aimed, postures, speeds, spans))


def _correction(observer: Observer) -> "_kernel.Correction":
    constants = np.array([*(observer.restoring * RESTORING), *SHARES, FADING])
    compiled = _kernel.make_observer(
        observer.forecast, observer.gain, observer.step, observer.full, observer.arrival, constants
    )
    noticed = np.array([noticing(observer.period), observer.period / FORGETTING, CLEAR_LOAD, LARGEST_CORRECTION])
    return _kernel.make_correction(compiled, observer.lower, observer.upper, noticed)


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
