"""Measures dry runs beside MuJoCo itself: the same steps of the same twins, with goals that were found before.

All times are CPU. Whole runs and bare physics take turns, so that a busy moment falls on both. Stages are measured one
by one, each beside its limit: bare physics, MuJoCo's inverse dynamics, or the memory that a stage reads and writes.
"""

from collections.abc import Callable, Mapping
from functools import partial
from statistics import median
from time import process_time
from typing import TypeVar

import mujoco
import numpy as np

from kinesic.bench.blocks import passage_text
from kinesic.bench.figure import Figure
from kinesic.body.command import RATE
from kinesic.controller.closed_loop import KERNEL, perform_in_twins
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.perform import dry_runs, make_observer, plan, set_up
from kinesic.controller.performance import Performance, Reference
from kinesic.controller.play import command_times
from kinesic.planning.plan import Plan
from kinesic.report.checks import checks
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors
from kinesic.sim.twin import STEP, Twin
from kinesic.studies.variants.sweep import GROUP, perform_variants
from kinesic.studies.variants.sweep import PHYSICS_STEP as SWEEP_STEP

ONE: tuple[Factors, ...] = (NOMINAL,)
BOTH: tuple[Factors, ...] = (NOMINAL, PESSIMISTIC)
REPETITIONS = 15
BLOCKS = 5  # passages that differ a little
SHARE_ONE, SHARE_BOTH = 0.6, 0.7  # goals: of the speed of bare physics
VARIANT, GROUPS = 20.0, 3  # [ms] goal for a variant of servos; groups of them that are measured, the first warms up
BYTES = 8  # of a number
ARRAYS = 12  # of the size of all steps' postures that measurements read or write
COPIED = 32 * 1024 * 1024  # [bytes] of an array that is copied to see what memory gives

T = TypeVar("T")


def bench() -> list[Figure]:
    """Measures the share of bare physics, with one twin and with two, and what each stage takes."""
    known = set_up()
    plans = [plan(passage_text(repetition), known) for repetition in range(BLOCKS)]
    return [
        *_shares("", plans, ONE, SHARE_ONE),
        *_shares("_both", plans, BOTH, SHARE_BOTH),
        *stages(plans),
        *_variants(plans),
    ]


def _variants(plans: list[Plan]) -> list[Figure]:
    """What a variant of the servos takes in a sweep, and what it has to: the same steps of bare physics."""
    groups = [tuple(Factors(gain=1.0 + (group * GROUP + k) / 1000) for k in range(GROUP)) for group in range(GROUPS)]
    perform_variants(plans[0], groups[0])
    spent = [timed(partial(perform_variants, planned, group))[0] for planned in plans for group in groups[1:]]
    motion = float(command_times(plans[0].duration)[-1])
    why = f"CPU, {1000 * SWEEP_STEP:g} ms steps of the physics, {motion:.1f} s of motion"
    return [Figure("speed.variant", 1000 * median(spent) / GROUP, "ms", VARIANT, "lower", why)]


def _shares(kind: str, plans: list[Plan], twins: tuple[Factors, ...], goal: float) -> list[Figure]:
    whole, bare, seconds = [], [], 0.0
    for repetition in range(REPETITIONS + 1):
        spent, performances = timed(partial(_judged, plans[repetition % len(plans)], twins))
        alone = sum(_bare_seconds(performance) for performance in performances)
        if repetition:  # the first one warms up
            whole.append(spent)
            bare.append(alone)
            seconds = float(performances[0].measured.times[-1])
    loop = f"kernel: {KERNEL}"
    return [
        Figure(f"speed.dry_run{kind}_of_bare", median(bare) / median(whole), "share", goal, "higher", loop),
        Figure(f"speed.dry_run{kind}", seconds / median(whole), "x real time", None, "higher", loop),
        Figure(f"speed.bare{kind}", seconds / median(bare), "x real time", None, "higher", "bare mj_step"),
    ]


def _judged(planned: Plan, twins: tuple[Factors, ...]) -> tuple[Performance, ...]:
    performances = dry_runs(planned, twins, watch=False)
    for performance in performances:
        checks(performance)
    return performances


def _bare_seconds(performance: Performance) -> float:
    """[s] of CPU of MuJoCo alone, one call for each command, with the goals that the performance has found."""
    start = performance.plan.trajectory.at(0.0).angles
    model, data = Twin(performance.plan.setup.robot, factors=performance.twin, start=start, touches=False).physics
    count = round(1.0 / RATE / STEP + 0.5)
    model.opt.timestep = 1.0 / RATE / count
    control, step, goals = data.ctrl, mujoco.mj_step, list(performance.measured.goals)
    began = process_time()
    for row in goals:
        control[:] = row
        step(model, data, count)
    return process_time() - began


def stages(plans: list[Plan]) -> list[Figure]:
    """Measures the stages of a dry run with one twin, in ms of CPU per second of motion."""
    spent: dict[str, list[float]] = {}
    least: dict[str, list[float]] = {}
    for planned in plans * (REPETITIONS // len(plans)):
        motion = float(command_times(planned.duration)[-1])
        for into, seconds in zip((spent, least), _stages(planned), strict=True):
            for name, value in seconds.items():
                into.setdefault(name, []).append(1000 * value / motion)
    whys = {name: f"limit {median(values):.2g}: {LIMITS[name]}" for name, values in least.items()}
    return [
        Figure(f"speed.stage_{name}", median(values), "ms/s", None, "lower", whys.get(name, ""))
        for name, values in spent.items()
    ]


LIMITS: Mapping[str, str] = {
    "feed_forward": "MuJoCo's inverse dynamics",
    "loop": "bare mj_step",
    "measurements": "memory bandwidth",
    "foreseen": "memory bandwidth",
    "checks": "memory bandwidth",
}


def _stages(planned: Plan) -> tuple[dict[str, float], dict[str, float]]:
    """[s] of CPU of each stage, and of what it cannot go below."""
    known, trajectory = planned.setup, planned.trajectory
    times = command_times(planned.duration)
    leading = FeedForward(known.robot, known.dynamics)
    observer = make_observer(known, NOMINAL, 0.0, 1)
    spent: dict[str, float] = {}
    spent["feed_forward"], setpoints = timed(lambda: leading.lead(trajectory, times))
    start = trajectory.at(0.0).angles
    spent["twin"], twin = timed(lambda: Twin(known.robot, start=start, touches=False))
    run = partial(perform_in_twins, trajectory, times, lambda part: setpoints, [twin])
    spent["loop"], _ = timed(lambda: list(run(lambda bodies: observer, lambda share: None)))
    spent["measurements"], measured = timed(twin.measurements)
    performance = Performance(Reference(planned, times, setpoints.duties), NOMINAL, measured, 0.0, 0.0)
    spent["foreseen"], _ = timed(lambda: performance.rooms)
    spent["checks"], _ = timed(lambda: checks(performance))
    moved, _ = timed(lambda: known.dynamics.torques(*trajectory.sample(times)))
    steps = round(1.0 / RATE / STEP + 0.5) * len(times) * len(known.robot.skeleton.hinges) * BYTES
    memory = ARRAYS * steps / _bandwidth()
    limits = {"feed_forward": moved, "loop": _bare_seconds(performance), "measurements": memory}
    return spent, limits | {"foreseen": memory / 3, "checks": memory / 3}


def _bandwidth() -> float:
    """[bytes/s] at which memory is copied, one core."""
    source = np.ones(COPIED // BYTES)
    target = np.empty_like(source)
    return 2 * COPIED / min(timed(lambda: np.copyto(target, source))[0] for _ in range(3))


def timed(work: Callable[[], T]) -> tuple[float, T]:
    """Does something, and measures the CPU [s] that it takes."""
    began = process_time()
    done = work()
    return process_time() - began, done
