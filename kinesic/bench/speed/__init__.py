"""Benchmark of planning and dry runs by stage."""

from kinesic.bench.metric import Metric
from kinesic.bench.speed import dry_runs, plans, starting

SPEED_PARTS = (dry_runs, plans, starting)


def bench() -> list[Metric]:
    """Measure the speed of dry runs, planning and program start."""
    return [metric for part in SPEED_PARTS for metric in part.bench()]
