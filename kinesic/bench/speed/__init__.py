"""Measures where the time goes, stage by stage, each beside what the machine allows at best."""

from kinesic.bench.figure import Figure
from kinesic.bench.speed import dry_runs, plans, starting

PARTS = (dry_runs, plans, starting)


def bench() -> list[Figure]:
    """Measures every figure of the part."""
    return [figure for part in PARTS for figure in part.bench()]
