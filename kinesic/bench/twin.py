"""The twin: how much faster than real time, and how near servos come to a plan."""

from statistics import median
from time import process_time

from kinesic.bench import following
from kinesic.bench.figure import Figure
from kinesic.bench.passage import passage
from kinesic.controller.perform import dry_runs, facts, plan
from kinesic.controller.performance import Performance
from kinesic.planning.plan import Plan
from kinesic.report.checks import checks
from kinesic.sim.servo_factors import Factors

REPETITIONS = 7


def bench() -> list[Figure]:
    """The passage in both twins: simulated time over feed-forward, physics and checks; then a set of documents."""
    known = facts()
    plans = [plan(passage(repetition), known) for repetition in range(REPETITIONS)]
    everyone = tuple(factors for _, factors in following.TWINS)
    _timed(plans[0], everyone)
    one = [_timed(planned, everyone[:1]) for planned in plans]
    both = [_timed(planned, everyone) for planned in plans]
    runs = [performance for _, performances in both for performance in performances]
    clearance = min(float(performance.measured.clearance.distances.min()) for performance in runs)
    return [
        Figure("twin.real_time", median(speed for speed, _ in one), "x", 100.0, "higher"),
        Figure("twin.real_time_both", median(speed for speed, _ in both), "x", 60.0, "higher"),
        Figure("twin.clearance", 1000 * clearance, "mm", 10.0, "higher"),
        *following.following(known, following.BLOCKS),
    ]


def _timed(planned: Plan, twins: tuple[Factors, ...]) -> tuple[float, tuple[Performance, ...]]:
    """Simulated time over time spent, and what was performed."""
    began = process_time()
    performances = dry_runs(planned, twins)
    for performance in performances:
        checks(performance)
    spent = process_time() - began
    return float(performances[0].measured.times[-1]) / spent, performances
