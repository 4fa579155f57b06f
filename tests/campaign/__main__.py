"""Run a campaign of random blocks, or continue an interrupted one.

Usage: `python -m tests.campaign --groups 1000 --seed 1 --jobs 2`. With `--near adult`, it plans all gestures in
all styles and 100 documents near adults instead of random blocks. It exits with 1 if anything failed.
"""

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kinesic.tasks.cluster import cluster
from kinesic.tasks.engine import Engine, Processes
from tests.campaign.near_people import plan_near_people
from tests.campaign.totals import Totals, run_campaign

GROUPS_PER_REPORT = 20  # finished groups between two progress lines


@contextmanager
def engine_of(jobs: int, address: str) -> Iterator[Engine]:
    """Open local processes, or the cluster at an address."""
    if not address:
        yield Processes(jobs)
        return
    with cluster(address) as engine:
        yield engine


def main() -> int:
    """Read options, run the groups, and print the totals."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--groups", type=int, default=1000, help="number of groups of 20 planned and 80 merged blocks")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="run this group alone, without journal")
    parser.add_argument("--jobs", type=int, default=1, help="number of local processes")
    parser.add_argument("--cluster", default="", metavar="ADDRESS", help="dask scheduler, secured by its configuration")
    parser.add_argument("--near", choices=("adult", "child"), help="plan all gestures and documents near this audience")
    parser.add_argument("--journal", type=Path, default=Path("out/campaign.jsonl"))
    options = parser.parse_args()
    numbers = range(options.groups) if options.only is None else [options.only]
    path = options.journal if options.only is None else None
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)

    def report(totals: Totals) -> None:
        if totals.groups % GROUPS_PER_REPORT == 0:
            print(f"{totals.groups} of {len(numbers)} groups, {totals.failed} failures", flush=True)

    with engine_of(options.jobs, options.cluster) as engine:
        if options.near is not None:
            lines, failures = plan_near_people(options.near, engine, path)
            print("\n".join((*lines, *failures)))
            return min(1, len(failures))
        totals = run_campaign([(options.seed, number) for number in numbers], engine, path, report)
    print("\n".join((*totals.lines(), *totals.failures)))
    return min(1, totals.failed)


if __name__ == "__main__":
    sys.exit(main())
