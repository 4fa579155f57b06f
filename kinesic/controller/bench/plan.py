"""Planning time: from text in memory to a certified motion."""

from statistics import median
from time import perf_counter

import numpy as np

from kinesic.controller.bench.figure import Figure
from kinesic.controller.bench.passage import passage
from kinesic.controller.checks import TOLERANCE
from kinesic.controller.facts import Facts
from kinesic.controller.perform import facts, plan
from kinesic.controller.plan import Plan
from kinesic.controller.syncs import SHIFT_TO_WARN
from kinesic.ik import KERNEL

REPETITIONS = 15


def bench() -> list[Figure]:
    """Times the passage, warm, and counts what its plans exceed."""
    known = facts()
    plan(passage(0), known)
    seconds, plans = [], []
    for repetition in range(1, REPETITIONS + 1):
        text = passage(repetition)
        began = perf_counter()
        plans.append(plan(text, known))
        seconds.append(perf_counter() - began)
    moved = [sum(abs(sync.planned - sync.asked) > SHIFT_TO_WARN for sync in found.syncs) for found in plans]
    return [
        Figure(f"plan.full_5s_{KERNEL}", 1000 * median(seconds), "ms", 300.0, "lower"),
        Figure("plan.full_5s_p95", 1000 * float(np.percentile(seconds, 95)), "ms", 300.0, "lower"),
        Figure("plan.violations", float(sum(_violations(found, known) for found in plans)), "count", 0.0, "lower"),
        Figure("plan.shifted_syncs", float(median(moved)), "count", 0.0, "lower"),
    ]


def _violations(planned: Plan, known: Facts) -> int:
    """Hinges whose position, speed or acceleration exceeds its limit at 1 kHz."""
    times = np.arange(0.0, planned.trajectory.duration, 1e-3)
    angles, speeds, accelerations = planned.trajectory.sample(times)
    limits = known.limits
    over = (
        (angles < limits.lower - 1e-9) | (angles > limits.upper + 1e-9),
        np.abs(speeds) > TOLERANCE * limits.speed,
        np.abs(accelerations) > TOLERANCE * limits.acceleration,
    )
    return int(sum(found.any(axis=0).sum() for found in over))
