"""Benchmark of planning: CPU times, kept limits and reported time shifts.

It measures time, limit violations and distance of key times from the optimum.
"""

from collections.abc import Callable, Iterable
from statistics import fmean, median
from time import perf_counter, process_time

import numpy as np

from kinesic.bench.blocks import write_overlapping_block, write_passage, write_rapid_head_block
from kinesic.bench.metric import Metric
from kinesic.bench.plan import hostile
from kinesic.bml.block import NoticeType
from kinesic.body.arrays import Floats
from kinesic.motion.condition import LEAD_IN, condition
from kinesic.motion.key_time_lp import shift_cost
from kinesic.motion.keys import Keys
from kinesic.motion.limit_check import CHECK_RATE, check_limits
from kinesic.motion.optimum import best_times
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, find_bonds
from kinesic.report.checks import LIMIT_TOLERANCE
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

PASSAGE_REPETITIONS = 9  # number of timed plans of the passage
CROWDED_BLOCKS = 4  # number of overlapping blocks whose time shifts are compared with the optimum
CPU_BLOCKS = 200  # number of timed blocks of overlapping gestures
REPEATED_BLOCKS = 6  # number of blocks with more repeated strokes than fit, whose times must be shifted
MAX_STRETCH = 1.15  # goal for shift cost / optimal shift cost, in total and at the median
MAX_WORST_STRETCH = 1.5  # goal for shift cost / optimal shift cost of the worst block
MIN_SHIFT_COST = 1e-6  # shift cost above which key times count as moved


def bench() -> list[Metric]:
    """Measure planning times of test blocks and check their plans."""
    setup = set_up()
    lexemes = [form.id for form in setup.lexicon.forms]
    plan(write_passage(0), setup)
    seconds, plans = _time_plans(write_passage, setup)
    hurried, moved = _time_plans(write_hurried_passage, setup)
    crowded = [plan(write_overlapping_block(seed, lexemes), setup) for seed in range(CROWDED_BLOCKS)]
    repeated = [plan(write_rapid_head_block(seed), setup) for seed in range(REPEATED_BLOCKS)]
    all_plans = [*plans, *moved, *crowded, *repeated]
    missing, false = (sum(counts) for counts in zip(*map(count_wrong_warnings, all_plans), strict=True))
    return [
        Metric("plan.full_5s_compiled", 1000 * median(seconds), "ms", 300.0, "lower"),
        Metric("plan.full_5s_p95", 1000 * float(np.percentile(seconds, 95)), "ms", 300.0, "lower"),
        Metric("plan.full_5s_moved", 1000 * median(hurried), "ms", 1000.0, "lower"),
        *cpu_metrics(setup, lexemes),
        *hostile.hostile_metrics(),
        Metric(
            "plan.violations", float(sum(count_violations(planned) for planned in all_plans)), "count", 0.0, "lower"
        ),
        Metric(
            "plan.shifted_syncs",
            float(median(len(_find_shifted_syncs(planned)) for planned in plans)),
            "count",
            0.0,
            "lower",
        ),
        Metric("plan.warnings_missing", float(missing), "count", 0.0, "lower"),
        Metric("plan.warnings_false", float(false), "count", 0.0, "lower"),
        *compare_with_optimum([*crowded, *repeated]),
    ]


def cpu_metrics(setup: Setup, lexemes: list[str]) -> list[Metric]:
    """Measure worst and mean planning CPU times by kind of block.

    Counted budgets bound these times.
    """
    classes: tuple[tuple[str, Callable[[int], str], int, float], ...] = (
        ("asked", write_passage, PASSAGE_REPETITIONS, 0.3),
        ("moved", write_hurried_passage, PASSAGE_REPETITIONS, 1.0),
        ("repeated", write_rapid_head_block, REPEATED_BLOCKS, 1.0),
        ("crowded", lambda seed: write_overlapping_block(seed, lexemes), CPU_BLOCKS, 1.0),
    )
    metrics = []
    for name, text_of, count, goal in classes:
        spent = [_measure_cpu_time(text_of(seed), setup) for seed in range(count)]
        metrics += [
            Metric(f"plan.cpu_{name}", max(spent), "s", goal, "lower", f"worst of {count}"),
            Metric(f"plan.cpu_{name}_mean", fmean(spent), "s", None, "lower", f"mean of {count}"),
        ]
    return metrics


def _measure_cpu_time(text: str, setup: Setup) -> float:
    """Return the CPU time [s] to plan a text."""
    began = process_time()
    plan(text, setup)
    return process_time() - began


def write_hurried_passage(repetition: int) -> str:
    """Return the passage with strokes too early for the servos to follow."""
    text = write_passage(repetition)
    later = 0.003 * (repetition % 17)
    for stroke, sooner in ((1.0, 0.45), (2.7, 2.3), (3.9, 3.0)):
        text = text.replace(f'stroke="{stroke + later:.3f}"', f'stroke="{sooner + later:.3f}"')
    return text


def _time_plans(text_of: Callable[[int], str], setup: Setup) -> tuple[list[float], list[Plan]]:
    seconds, plans = [], []
    for repetition in range(1, PASSAGE_REPETITIONS + 1):
        text = text_of(repetition)
        began = perf_counter()
        plans.append(plan(text, setup))
        seconds.append(perf_counter() - began)
    return seconds, plans


def count_violations(planned: Plan) -> int:
    """Count joint and motor-duty limits that a motion exceeds at 1 kHz."""
    setup = planned.setup
    peaks = check_limits(planned.trajectory, setup.limits).by_quantity.values()
    return sum(int((peak.ratios > LIMIT_TOLERANCE).sum()) for peak in peaks) + int(
        (largest_duty(planned) > LIMIT_TOLERANCE).sum()
    )


def largest_duty(planned: Plan) -> Floats:
    """Return the largest motor duty of each drive (n,).

    It is a fraction of the full duty.
    """
    setup = planned.setup
    times = np.arange(0.0, planned.trajectory.duration, 1.0 / CHECK_RATE)
    angles, velocities, accelerations = planned.trajectory.sample(times)
    torques = setup.dynamics.torques(angles, velocities, accelerations)
    return np.asarray(np.abs(torques / setup.robot.drives.stall + velocities * setup.limits.viscous).max(axis=0))


def count_wrong_warnings(planned: Plan) -> tuple[int, int]:
    """Count shifted sync points without a warning, and warnings without a shift."""
    warned = {
        (notice.id, sync)
        for notice in planned.notices
        if notice.type == NoticeType.IMPOSSIBLE_TO_SCHEDULE and " requested at " in notice.text
        for sync in notice.text.partition(" requested at ")[0].split(" and ")
    }
    shifted = _find_shifted_syncs(planned)
    return len(shifted - warned), len(warned - shifted)


def _find_shifted_syncs(planned: Plan) -> set[tuple[str, str]]:
    """Return the sync points shifted enough to require a warning."""
    block = planned.timeline.block.id
    return {
        (f"{block}:{sync.behaviour}", sync.sync)
        for sync in planned.syncs
        if abs(sync.planned - sync.requested) > SHIFT_TO_WARN
    }


def compare_with_optimum(crowded: Iterable[Plan]) -> list[Metric]:
    """Compare weighted key-time shifts with shifts by a nonlinear optimizer.

    The ratios are given in total, at the median and at worst.
    """
    costs, optimal_costs = [], []
    for planned in crowded:
        setup, bonds = planned.setup, find_bonds(planned.timeline)
        keys = Keys.of(planned.postures.postures, setup.limits, bonds)
        motion = condition(planned.postures.postures, setup.limits, bonds=bonds)
        if (moved := shift_cost(keys, motion.planned)) < MIN_SHIFT_COST:
            continue
        optimum = best_times(keys, motion, setup.limits, LEAD_IN)
        if optimum is not None:
            costs.append(moved)
            optimal_costs.append(optimum.shift_cost)
    ratios = np.array(costs) / np.array(optimal_costs)
    why = "" if costs else "no block's times had to move"
    return [
        Metric("plan.stretch", sum(costs) / sum(optimal_costs) if costs else None, "x", MAX_STRETCH, "lower", why),
        Metric("plan.stretch_median", float(np.median(ratios)) if costs else None, "x", MAX_STRETCH, "lower", why),
        Metric("plan.stretch_worst", float(ratios.max()) if costs else None, "x", MAX_WORST_STRETCH, "lower", why),
        Metric("plan.stretch_blocks", float(len(costs)), "count", None, "higher"),
    ]
