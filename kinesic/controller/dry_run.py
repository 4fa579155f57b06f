"""Performance of plans in twins."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from time import perf_counter

import numpy as np

from kinesic.body.arrays import seal_in_place
from kinesic.body.choices import InvertedTerms
from kinesic.body.command import COMMAND_RATE, Measurements
from kinesic.controller.closed_loop import perform_in_twins
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.learned_gains import reduce_stiffness
from kinesic.controller.observer import Observer
from kinesic.controller.stability import find_stable_fraction
from kinesic.controller.watch.clearance import needs_slowing
from kinesic.controller.watch.watched_run import perform_watched
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.reference import Reference
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.stepping.simulation import borrow_simulations
from kinesic.sim.twin import MAX_PHYSICS_STEP, Twin


def dry_run(
    planned: Plan,
    *,
    twin: Factors = NOMINAL_FACTORS,
    feedforward: InvertedTerms = "full",
    correction: bool = True,
    watch: bool = True,
    delay: float = 0.0,
    believed: Factors = NOMINAL_FACTORS,
) -> DryRun:
    """Perform a plan in one simulated twin, with the options of `dry_runs`."""
    return dry_runs(
        planned, (twin,), feedforward=feedforward, correction=correction, watch=watch, delay=delay, believed=believed
    )[0]


def dry_runs(
    planned: Plan,
    twins: Sequence[Factors],
    *,
    feedforward: InvertedTerms = "full",
    correction: bool = True,
    watch: bool = True,
    delay: float = 0.0,
    believed: Factors = NOMINAL_FACTORS,
    step: float = MAX_PHYSICS_STEP,
    progress: Callable[[float], None] = lambda fraction: None,
) -> tuple[DryRun, ...]:
    """Perform a plan in twins, one per set of servo factors.

    Computations that do not depend on the twin are done once.

    Args:
        planned: plan to be performed.
        twins: deviation of each twin from the robot's description.
        feedforward: inverted terms of the servo model.
        correction: whether setpoints are corrected by the measurements.
        watch: whether a twin with too little clearance is slowed down, and stopped before contact.
        delay: [s] bus delay assumed by feed-forward and correction; that of a twin is in its factors.
        believed: servo estimate of the feed-forward, such as the result of `identify_servos`.
        step: [s] longest physics step; a watched run has its own.
        progress: receives the finished fraction of the ticks from time to time.
    """
    setup, trajectory, robot = planned.setup, planned.trajectory, planned.setup.robot
    began = perf_counter()
    times = planned.command_times
    feed_forward = FeedForward.of(robot, setup.dynamics, believed, delay=delay, terms=feedforward)
    delay = float(feed_forward.delay)
    observers = partial(_copy_observer, setup, believed, delay) if correction else None
    compute_setpoints, start = partial(feed_forward.compute_setpoints, trajectory), trajectory.at(0.0).angles
    duties = np.empty((len(times), len(start)))

    def simulate(*, touches: bool) -> list[Measurements]:
        with borrow_simulations(robot, twins, touches=touches) as simulations:
            bodies = [
                Twin(robot, factors=factors, step=step, start=start, touches=touches, simulation=simulation)
                for factors, simulation in zip(twins, simulations, strict=True)
            ]
            recorders = [body.recorder(len(duties)) for body in bodies]
            for window in perform_in_twins(trajectory, times, compute_setpoints, bodies, observers, progress):
                bodies[window.twin].record(recorders[window.twin])  # while its steps are in the cache
                duties[window.commands] = window.setpoints.duties
            return [recorder.measurements() for recorder in recorders]

    single_observer = observers(1) if observers else None
    restoring = 1.0 if single_observer is None else single_observer.restoring
    measured = simulate(touches=False)
    if min(measurements.clearance.distances.min() for measurements in measured) < robot.min_clearance:
        measured = simulate(touches=True)  # capsules may touch between the steps
    reference, seconds = Reference(planned, times, seal_in_place(duties)), perf_counter() - began
    runs = [
        DryRun(reference, factors, measurements, seconds, servo_estimate=believed, restoring=restoring)
        for factors, measurements in zip(twins, measured, strict=True)
    ]
    return tuple(
        _perform_watched(run, feed_forward, single_observer)
        if watch and needs_slowing(run.clearance_forecast, robot)
        else run
        for run in runs
    )


def _perform_watched(even_run: DryRun, feedforward: FeedForward, observer: Observer | None) -> DryRun:
    """Repeat a dry run, slowed while the clearance is too small."""
    began, plan = perf_counter(), even_run.plan
    twin = Twin(plan.setup.robot, factors=even_run.twin, start=plan.trajectory.at(0.0).angles)
    run = perform_watched(plan, twin, feedforward, observer)
    seconds = even_run.dry_run_seconds + perf_counter() - began
    return DryRun(
        Reference(plan, run.times, run.duties),
        even_run.twin,
        run.measured,
        seconds,
        run.min_pace,
        even_run.servo_estimate,
        even_run.restoring,
    )


@lru_cache(maxsize=8)
def make_observer(setup: Setup, believed: Factors, delay: float, bodies: int) -> Observer:
    """Make the disturbance observer of a robot with estimated servo stiffness.

    Its restoring gain is the largest that these servos tolerate.
    """
    design = partial(
        Observer.of, reduce_stiffness(setup.robot, believed), setup.dynamics, period=1 / COMMAND_RATE, delay=delay
    )
    fraction = find_stable_fraction(design(), believed.applied(setup.robot), setup.dynamics, delay)
    return replace(design(bodies=bodies), restoring=fraction)


def _copy_observer(setup: Setup, believed: Factors, delay: float, bodies: int) -> Observer:
    """Copy a cached observer, so that threads use separate buffers.

    Several threads may then perform at once.
    """
    return replace(make_observer(setup, believed, delay, bodies))
