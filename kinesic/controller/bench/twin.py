"""The twin: how much faster than real time, how near to the plan, on nominal and pessimistic servos."""

from statistics import median
from time import perf_counter

import numpy as np

from kinesic.controller.bench.figure import Figure
from kinesic.controller.bench.passage import passage
from kinesic.controller.checks import checks, stroke_errors
from kinesic.controller.perform import dry_run, facts, plan
from kinesic.controller.performance import Performance
from kinesic.sim.factors import NOMINAL, PESSIMISTIC, Factors

REPETITIONS = 7


def bench() -> list[Figure]:
    """Performs the passage in both twins: simulated time over feed-forward, physics and checks; no film, no page."""
    known = facts()
    plans = [plan(passage(repetition), known) for repetition in range(REPETITIONS)]
    checks(dry_run(plans[0]))
    figures: list[Figure] = []
    runs: dict[str, list[Performance]] = {}
    seconds: dict[str, list[float]] = {}
    goals: tuple[tuple[str, Factors, float], ...] = (("nominal", NOMINAL, 0.2), ("pessimistic", PESSIMISTIC, 1.0))
    for name, factors, _ in goals:
        for planned in plans:
            began = perf_counter()
            performance = dry_run(planned, twin=factors)
            checks(performance)
            seconds.setdefault(name, []).append(perf_counter() - began)
            runs.setdefault(name, []).append(performance)
    durations = [float(performance.measured.times[-1]) for performance in runs["nominal"]]
    one = [duration / spent for duration, spent in zip(durations, seconds["nominal"], strict=True)]
    both = [d / (a + b) for d, a, b in zip(durations, seconds["nominal"], seconds["pessimistic"], strict=True)]
    figures.append(Figure("twin.real_time", median(one), "x", 100.0, "higher"))
    figures.append(Figure("twin.real_time_both", median(both), "x", 60.0, "higher"))
    for name, _, goal in goals:
        rmse = median(_rmse(performance) for performance in runs[name])
        figures.append(Figure(f"twin.rmse_{name}", rmse, "deg", goal, "lower"))
        errors = [abs(e) for performance in runs[name] for e, _ in stroke_errors(performance) if e is not None]
        figures.append(Figure(f"twin.stroke_median_{name}", 1000 * median(errors), "ms", 15.0, "lower"))
        figures.append(Figure(f"twin.stroke_p95_{name}", 1000 * float(np.percentile(errors, 95)), "ms", 30.0, "lower"))
    clearance = min(float(p.measured.clearance.distances.min()) for found in runs.values() for p in found)
    figures.append(Figure("twin.clearance", 1000 * clearance, "mm", 10.0, "higher"))
    return figures


def _rmse(performance: Performance) -> float:
    errors = performance.errors[np.isfinite(performance.errors)]
    return float(np.degrees(np.sqrt(np.mean(errors**2))))
