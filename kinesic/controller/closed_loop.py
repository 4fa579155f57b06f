"""Compiled closed loop of commands, observer correction and twin physics.

The loop runs window by window, so that the measurements of a long motion can be processed on the way. A twin with a
sagging supply, or an unknown build of MuJoCo, runs tick by tick in Python, slower and in one window.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kinesic._kernel import controller as kernel
from kinesic.body.arrays import Floats
from kinesic.body.command import COMMAND_RATE, Command
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.controller.observer import (
    FORGETTING_TIME,
    MAX_CORRECTION,
    REGULARISATION_OFFSET,
    Observer,
    correct_setpoints,
    detection_rate,
)
from kinesic.controller.play import commands, play_together
from kinesic.motion.trajectory import Trajectory
from kinesic.sim.stepping.addresses import TwinParts
from kinesic.sim.stepping.friction_step import FrictionParts
from kinesic.sim.stepping.step_log import StepRecord
from kinesic.sim.twin import Twin

COMMANDS_PER_WINDOW = 2048  # commands per batch; the twin's recorded steps of one batch fit into the processor cache

SetpointFunction = Callable[[Floats], FeedForwardSetpoints]  # maps sending times (m,) [s] to setpoints


@dataclass(frozen=True, eq=False)
class CommandWindow:
    """Batch of commands that one twin has just performed."""

    twin: int  # index of the twin
    commands: slice  # indices among all commands
    setpoints: FeedForwardSetpoints  # feed-forward setpoints of these commands


def perform_in_twins(
    trajectory: Trajectory,
    times: Floats,
    compute_setpoints: SetpointFunction,
    twins: Sequence[Twin],
    observers: Callable[[int], Observer] | None,
    progress: Callable[[float], None],
) -> Iterator[CommandWindow]:
    """Perform a motion in new twins, yielding each batch of commands.

    To process measurements by windows, call the twin's `record` before taking the next window.

    Args:
        trajectory: of the motion.
        times: (m,) [s] performance times of the commands.
        compute_setpoints: feed-forward of the servos.
        twins: each follows the commands on its own.
        observers: returns the observer of a number of bodies; None: no correction.
        progress: receives the finished fraction of the ticks from time to time.

    Yields:
        Twin and commands of each finished window.

    Raises:
        ValueError: times decrease, or there are none.
    """
    parts = [twin.parts() for twin in twins]
    compiled_parts = [part for part in parts if part is not None]
    if len(compiled_parts) < len(twins):
        setpoints = compute_setpoints(times)
        _perform_tick_by_tick(trajectory, times, setpoints, twins, observers, progress)
        yield from (CommandWindow(k, slice(0, len(times)), setpoints) for k in range(len(twins)))
        return
    observer = observers(1) if observers else None
    loops = [CompiledLoop(twin, part, observer) for twin, part in zip(twins, compiled_parts, strict=True)]
    for begin in range(0, len(times), COMMANDS_PER_WINDOW):
        rows = slice(begin, min(begin + COMMANDS_PER_WINDOW, len(times)))
        setpoints = compute_setpoints(times[rows])
        angles = trajectory.angles(times[rows]) if observer else setpoints.setpoints
        for k, loop in enumerate(loops):
            done = begin + k * (rows.stop - begin) / len(loops)
            loop.perform(
                times[rows], angles, setpoints, partial(_report_progress, progress, done, len(loops), len(times))
            )
            yield CommandWindow(k, rows, setpoints)


def _report_progress(progress: Callable[[float], None], done: float, loops: int, ticks: int, tick: int) -> None:
    """Report the completed fraction of several control loops.

    Args:
        progress: receives the fraction.
        done: finished ticks before this window.
        loops: number of loops.
        ticks: number of all ticks.
        tick: of the window.
    """
    progress((done + tick / loops) / ticks)


class CompiledLoop:
    """Compiled control loop of one simulated robot.

    Each call of `perform` continues from the state at the end of the previous one.
    """

    def __init__(self, twin: Twin, parts: TwinParts, observer: Observer | None) -> None:
        """Prepare the compiled loop, before its first command.

        Args:
            twin: new twin.
            parts: of its physics.
            observer: of one body; None: no correction.
        """
        self._twin, self._size = twin, len(parts.positions)
        self._physics = kernel.make_physics(*(getattr(parts, name) for name in TwinParts.__dataclass_fields__))
        if stages := twin.friction_parts():
            kernel.split_steps(self._physics, *(getattr(stages, name) for name in FrictionParts.__dataclass_fields__))
        self._correction = None if observer is None else _correction(observer)
        self._under_way = np.empty((0, len(parts.hinges)))  # (w, n) [rad] setpoints in flight

    def perform(
        self, times: Floats, angles: Floats, setpoints: FeedForwardSetpoints, report_tick: Callable[[int], None]
    ) -> None:
        """Perform commands and record the twin's steps.

        Args:
            times: (m,) [s] of the commands.
            angles: (m, n) [rad] reference.
            setpoints: feed-forward at these times.
            report_tick: receives the tick of the window from time to time.
        """
        led = angles, setpoints.setpoints, setpoints.loads, setpoints.leads
        postures, speeds, spans, aimed, counts, sent = kernel.perform(
            self._physics, times, led, self._correction, report_tick, COMMAND_RATE
        )
        goals = sent.reshape(angles.shape)
        coming = np.concatenate([self._under_way, goals])
        aims, self._under_way = coming[: len(aimed)], coming[len(aimed) :].copy()
        postures, speeds = postures.reshape(-1, self._size), speeds.reshape(-1, self._size)
        self._twin.take(StepRecord(times, goals, counts, aims, aimed, postures, speeds, spans))


def _correction(observer: Observer) -> kernel.Correction:
    rates = detection_rate(observer.period), observer.period / FORGETTING_TIME
    constants = np.array([*rates, REGULARISATION_OFFSET, MAX_CORRECTION])
    return kernel.make_correction(observer.compiled, observer.lower, observer.upper, constants)


def _perform_tick_by_tick(
    trajectory: Trajectory,
    times: Floats,
    setpoints: FeedForwardSetpoints,
    twins: Sequence[Twin],
    observers: Callable[[int], Observer] | None,
    progress: Callable[[float], None],
) -> None:
    stream = tuple(commands(trajectory, times, setpoints))
    ticks: Iterator[tuple[Command, ...]] = ((command,) * len(twins) for command in stream)
    if observers:
        ticks = correct_setpoints(stream, setpoints, twins, observers(len(twins)))
    play_together(_report_ticks(ticks, len(stream), progress), twins)


def _report_ticks(
    ticks: Iterator[tuple[Command, ...]], count: int, progress: Callable[[float], None]
) -> Iterator[tuple[Command, ...]]:
    """Yield ticks, reporting the completed fraction every second of performance time."""
    for k, tick in enumerate(ticks):
        yield tick
        if k % COMMAND_RATE == 0:
            progress(k / count)
