"""Measures planning: how long it takes, what it exceeds, and how far from the optimum times move."""

from collections.abc import Callable, Iterable
from statistics import fmean, median
from time import perf_counter, process_time

import numpy as np

from kinesic.bench.blocks import crowd, passage_text, rhythm
from kinesic.bench.figure import Figure
from kinesic.bench.plan import hostile
from kinesic.bench.plan.optimum import best_times
from kinesic.bml.block import NoticeType
from kinesic.body.arrays import Floats
from kinesic.controller.perform import plan, set_up
from kinesic.ik import KERNEL
from kinesic.motion.condition import LEAD_IN, condition
from kinesic.motion.key_time_lp import strain
from kinesic.motion.keys import Keys
from kinesic.motion.limit_check import CHECK_RATE, check_limits
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, find_bonds
from kinesic.report.checks import TOLERANCE

REPETITIONS = 9
CROWDS = 4  # blocks whose times must move
THRONGED = 200  # of them, whose CPU is measured: one in twenty takes four times as long as most
RHYTHMS = 6  # blocks with repeated strokes whose times must move
STRETCH, STRETCH_WORST = 1.15, 1.5  # goals: shifts over those of the optimum
STRAINED = 1e-6  # strain above which times have moved


def bench() -> list[Figure]:
    """Times the passage and a hurried one, warm, and judges their plans and those of crowded blocks."""
    known = set_up()
    lexemes = [form.id for form in known.lexicon.forms]
    plan(passage_text(0), known)
    seconds, plans = _timed(passage_text, known)
    hurried, moved = _timed(hurry, known)
    crowded = [plan(crowd(seed, lexemes), known) for seed in range(CROWDS)]
    repeated = [plan(rhythm(seed), known) for seed in range(RHYTHMS)]
    every = [*plans, *moved, *crowded, *repeated]
    missing, false = (sum(found) for found in zip(*map(count_wrong_warnings, every), strict=True))
    return [
        Figure(f"plan.full_5s_{KERNEL}", 1000 * median(seconds), "ms", 300.0, "lower"),
        Figure("plan.full_5s_p95", 1000 * float(np.percentile(seconds, 95)), "ms", 300.0, "lower"),
        Figure("plan.full_5s_moved", 1000 * median(hurried), "ms", 1000.0, "lower"),
        *cpu_figures(known, lexemes),
        *hostile.figures(),
        Figure("plan.violations", float(sum(violations(found) for found in every)), "count", 0.0, "lower"),
        Figure("plan.shifted_syncs", float(median(len(_shifted(found)) for found in plans)), "count", 0.0, "lower"),
        Figure("plan.warnings_missing", float(missing), "count", 0.0, "lower"),
        Figure("plan.warnings_false", float(false), "count", 0.0, "lower"),
        *stretch([*crowded, *repeated]),
    ]


def cpu_figures(known: Setup, lexemes: list[str]) -> list[Figure]:
    """Measures the CPU that plans of each class of blocks take, at worst and on average; counted budgets bound it."""
    classes: tuple[tuple[str, Callable[[int], str], int, float], ...] = (
        ("asked", passage_text, REPETITIONS, 0.3),
        ("moved", hurry, REPETITIONS, 1.0),
        ("repeated", rhythm, RHYTHMS, 1.0),
        ("crowded", lambda seed: crowd(seed, lexemes), THRONGED, 1.0),
    )
    figures = []
    for name, text_of, count, goal in classes:
        spent = [_cpu(text_of(seed), known) for seed in range(count)]
        figures += [
            Figure(f"plan.cpu_{name}", max(spent), "s", goal, "lower", f"the worst of {count}"),
            Figure(f"plan.cpu_{name}_mean", fmean(spent), "s", None, "lower", f"of {count}"),
        ]
    return figures


def _cpu(text: str, known: Setup) -> float:
    """[s] of CPU that a plan takes."""
    began = process_time()
    plan(text, known)
    return process_time() - began


def hurry(repetition: int) -> str:
    """Writes the passage with strokes that come too soon after what is before them for servos to follow."""
    text = passage_text(repetition)
    later = 0.003 * (repetition % 17)
    for stroke, sooner in ((1.0, 0.45), (2.7, 2.3), (3.9, 3.0)):
        text = text.replace(f'stroke="{stroke + later:.3f}"', f'stroke="{sooner + later:.3f}"')
    return text


def _timed(text_of: Callable[[int], str], known: Setup) -> tuple[list[float], list[Plan]]:
    seconds, plans = [], []
    for repetition in range(1, REPETITIONS + 1):
        text = text_of(repetition)
        began = perf_counter()
        plans.append(plan(text, known))
        seconds.append(perf_counter() - began)
    return seconds, plans


def violations(planned: Plan) -> int:
    """Counts limits of hinges that a motion exceeds at 1 kHz, those of the drives' true duty included."""
    known = planned.setup
    shares = check_limits(planned.trajectory, known.limits).shares.values()
    return sum(int((peak.ratios > TOLERANCE).sum()) for peak in shares) + int((duty(planned) > TOLERANCE).sum())


def duty(planned: Plan) -> Floats:
    """(n,) the largest share of full duty that inverse dynamics finds for each drive at 1 kHz."""
    known = planned.setup
    times = np.arange(0.0, planned.trajectory.duration, 1.0 / CHECK_RATE)
    angles, speeds, accelerations = planned.trajectory.sample(times)
    torques = known.dynamics.torques(angles, speeds, accelerations)
    return np.asarray(np.abs(torques / known.robot.drives.stall + speeds * known.limits.viscous).max(axis=0))


def count_wrong_warnings(planned: Plan) -> tuple[int, int]:
    """Counts shifted sync points without a warning, and warnings about sync points that did not shift."""
    warned = {
        (notice.id, notice.text.partition(" asked at ")[0])
        for notice in planned.notices
        if notice.type == NoticeType.IMPOSSIBLE_TO_SCHEDULE and " asked at " in notice.text
    }
    shifted = _shifted(planned)
    return len(shifted - warned), len(warned - shifted)


def _shifted(planned: Plan) -> set[tuple[str, str]]:
    """Behaviours and sync points that are moved by more than may go unsaid."""
    block = planned.timeline.block.id
    return {
        (f"{block}:{sync.behaviour}", sync.sync)
        for sync in planned.syncs
        if abs(sync.planned - sync.asked) > SHIFT_TO_WARN
    }


def stretch(crowded: Iterable[Plan]) -> list[Figure]:
    """Compares weighted shifts of key times with the nonlinear optimum: in total, at the median, at worst."""
    ours, best = [], []
    for planned in crowded:
        known, ties = planned.setup, find_bonds(planned.timeline)
        keys = Keys.of(planned.postures.postures, known.limits, ties)
        motion = condition(planned.postures.postures, known.limits, bonds=ties)
        if (moved := strain(keys, motion.planned)) < STRAINED:
            continue
        least = best_times(keys, motion, known.limits, LEAD_IN)
        if least is not None:
            ours.append(moved)
            best.append(least.strain)
    ratios = np.array(ours) / np.array(best)
    why = "" if ours else "no block's times had to move"
    return [
        Figure("plan.stretch", sum(ours) / sum(best) if ours else None, "x", STRETCH, "lower", why),
        Figure("plan.stretch_median", float(np.median(ratios)) if ours else None, "x", STRETCH, "lower", why),
        Figure("plan.stretch_worst", float(ratios.max()) if ours else None, "x", STRETCH_WORST, "lower", why),
        Figure("plan.stretch_blocks", float(len(ours)), "count", None, "higher"),
    ]
