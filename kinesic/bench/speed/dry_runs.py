"""Benchmark of dry runs relative to bare MuJoCo steps.

Bare MuJoCo gets the setpoints that the dry run found.

All times are CPU times. Whole runs and bare physics alternate, so that other load affects both. Each stage is compared
with its limit: bare physics, MuJoCo's inverse dynamics, or the memory that the stage reads and writes.
"""

from collections.abc import Callable, Mapping
from functools import partial
from statistics import median
from time import process_time
from typing import TypeVar

import mujoco
import numpy as np

from kinesic.bench.blocks import write_passage
from kinesic.bench.metric import Metric
from kinesic.body.command import COMMAND_RATE
from kinesic.controller.closed_loop import perform_in_twins
from kinesic.controller.dry_run import dry_runs, make_observer
from kinesic.controller.feedforward import FeedForward
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.reference import Reference
from kinesic.planning.plan import Plan
from kinesic.report.checks import checks
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors
from kinesic.sim.twin import MAX_PHYSICS_STEP, Twin
from kinesic.studies.variants.sweep import GROUP_SIZE, perform_variants
from kinesic.studies.variants.sweep import PHYSICS_STEP as SWEEP_STEP

ONE_TWIN: tuple[Factors, ...] = (NOMINAL_FACTORS,)
BOTH_TWINS: tuple[Factors, ...] = (NOMINAL_FACTORS, PESSIMISTIC_FACTORS)
RUN_REPETITIONS = 15  # number of timed dry runs
PASSAGE_COUNT = 5  # number of time-shifted copies of the passage
MIN_RATIO_ONE = 0.6  # goal for bare physics time / dry run time with one twin
MIN_RATIO_BOTH = 0.7  # goal for bare physics time / dry run time with two twins
MAX_VARIANT_TIME = 20.0  # [ms] goal for the time of one servo variant
VARIANT_GROUPS = 3  # number of groups of servo variants; the first warms up and is not timed
FLOAT_BYTES = 8  # [bytes] size of a 64-bit float
MEASURED_ARRAYS = 12  # number of posture arrays over all steps that measurements read or write
COPY_SIZE = 32 * 1024 * 1024  # [bytes] size of the array copied to measure memory bandwidth

T = TypeVar("T")


def bench() -> list[Metric]:
    """Measure dry-run speed relative to bare physics, and each stage's time."""
    setup = set_up()
    plans = [plan(write_passage(repetition), setup) for repetition in range(PASSAGE_COUNT)]
    return [
        *_speed_ratios("", plans, ONE_TWIN, MIN_RATIO_ONE),
        *_speed_ratios("_both", plans, BOTH_TWINS, MIN_RATIO_BOTH),
        *stages(plans),
        *_measure_variants(plans),
    ]


def _measure_variants(plans: list[Plan]) -> list[Metric]:
    """Measure the time per servo variant in a parameter sweep."""
    groups = [
        tuple(Factors(gain=1.0 + (group * GROUP_SIZE + k) / 1000) for k in range(GROUP_SIZE))
        for group in range(VARIANT_GROUPS)
    ]
    perform_variants(plans[0], groups[0])
    spent = [time_call(partial(perform_variants, planned, group))[0] for planned in plans for group in groups[1:]]
    motion = float(plans[0].command_times[-1])
    why = f"CPU, {1000 * SWEEP_STEP:g} ms steps of the physics, {motion:.1f} s of motion"
    return [Metric("speed.variant", 1000 * median(spent) / GROUP_SIZE, "ms", MAX_VARIANT_TIME, "lower", why)]


def _speed_ratios(kind: str, plans: list[Plan], twins: tuple[Factors, ...], goal: float) -> list[Metric]:
    whole, bare, seconds = [], [], 0.0
    for repetition in range(RUN_REPETITIONS + 1):
        spent, performances = time_call(partial(_run_and_check, plans[repetition % len(plans)], twins))
        bare_time = sum(_time_bare_physics(performance) for performance in performances)
        if repetition:  # the first run warms up
            whole.append(spent)
            bare.append(bare_time)
            seconds = float(performances[0].measured.times[-1])
    loop = "kernel: compiled"
    return [
        Metric(f"speed.dry_run{kind}_of_bare", median(bare) / median(whole), "share", goal, "higher", loop),
        Metric(f"speed.dry_run{kind}", seconds / median(whole), "x real time", None, "higher", loop),
        Metric(f"speed.bare{kind}", seconds / median(bare), "x real time", None, "higher", "bare mj_step"),
    ]


def _run_and_check(planned: Plan, twins: tuple[Factors, ...]) -> tuple[DryRun, ...]:
    performances = dry_runs(planned, twins, watch=False)
    for performance in performances:
        checks(performance)
    return performances


def _time_bare_physics(performance: DryRun) -> float:
    """Return the CPU time [s] of MuJoCo alone, one call per command.

    It gets the setpoints that the performance found.
    """
    start = performance.plan.trajectory.at(0.0).angles
    model, data = Twin(performance.plan.setup.robot, factors=performance.twin, start=start, touches=False).physics
    count = round(1.0 / COMMAND_RATE / MAX_PHYSICS_STEP + 0.5)
    model.opt.timestep = 1.0 / COMMAND_RATE / count
    control, step, goals = data.ctrl, mujoco.mj_step, list(performance.measured.setpoints)
    began = process_time()
    for row in goals:
        control[:] = row
        step(model, data, count)
    return process_time() - began


def stages(plans: list[Plan]) -> list[Metric]:
    """Measure each dry-run stage's CPU time per second of motion [ms/s]."""
    spent: dict[str, list[float]] = {}
    limits_by_stage: dict[str, list[float]] = {}
    for planned in plans * (RUN_REPETITIONS // len(plans)):
        motion = float(planned.command_times[-1])
        for into, seconds in zip((spent, limits_by_stage), _time_stages(planned), strict=True):
            for name, value in seconds.items():
                into.setdefault(name, []).append(1000 * value / motion)
    whys = {name: f"limit {median(values):.2g}: {STAGE_LIMITS[name]}" for name, values in limits_by_stage.items()}
    return [
        Metric(f"speed.stage_{name}", median(values), "ms/s", None, "lower", whys.get(name, ""))
        for name, values in spent.items()
    ]


STAGE_LIMITS: Mapping[str, str] = {
    "feed_forward": "MuJoCo's inverse dynamics",
    "loop": "bare mj_step",
    "measurements": "memory bandwidth",
    "foreseen": "memory bandwidth",
    "checks": "memory bandwidth",
}


def _time_stages(planned: Plan) -> tuple[dict[str, float], dict[str, float]]:
    """Return CPU time [s] and its lower limit [s] by dry-run stage."""
    setup, trajectory = planned.setup, planned.trajectory
    times = planned.command_times
    feed_forward = FeedForward(setup.robot, setup.dynamics)
    observer = make_observer(setup, NOMINAL_FACTORS, 0.0, 1)
    spent: dict[str, float] = {}
    spent["feed_forward"], setpoints = time_call(lambda: feed_forward.compute_setpoints(trajectory, times))
    start = trajectory.at(0.0).angles
    spent["twin"], twin = time_call(lambda: Twin(setup.robot, start=start, touches=False))
    run = partial(perform_in_twins, trajectory, times, lambda part: setpoints, [twin])
    spent["loop"], _ = time_call(lambda: list(run(lambda bodies: observer, lambda share: None)))
    spent["measurements"], measured = time_call(twin.measurements)
    performance = DryRun(Reference(planned, times, setpoints.duties), NOMINAL_FACTORS, measured, 0.0)
    spent["foreseen"], _ = time_call(lambda: performance.clearance_forecast)
    spent["checks"], _ = time_call(lambda: checks(performance))
    moved, _ = time_call(lambda: setup.dynamics.torques(*trajectory.sample(times)))
    steps = (
        round(1.0 / COMMAND_RATE / MAX_PHYSICS_STEP + 0.5) * len(times) * len(setup.robot.skeleton.hinges) * FLOAT_BYTES
    )
    memory = MEASURED_ARRAYS * steps / _measure_bandwidth()
    limits = {"feed_forward": moved, "loop": _time_bare_physics(performance), "measurements": memory}
    return spent, limits | {"foreseen": memory / 3, "checks": memory / 3}


def _measure_bandwidth() -> float:
    """Return the copy bandwidth of one core [bytes/s]."""
    source = np.ones(COPY_SIZE // FLOAT_BYTES)
    target = np.empty_like(source)
    return 2 * COPY_SIZE / min(time_call(lambda: np.copyto(target, source))[0] for _ in range(3))


def time_call(work: Callable[[], T]) -> tuple[float, T]:
    """Call a function and return its CPU time [s] and its result."""
    began = process_time()
    done = work()
    return process_time() - began, done
