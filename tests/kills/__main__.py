"""Dry runs whose workers are killed at random times.

Usage: `python -m tests.kills --count 10000 --every 20`.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

from kinesic.tasks.cluster import cluster
from kinesic.tasks.engine import Engine, Processes
from tests.kills.under_fire import perform_under_fire
from tests.tasks.dask_programs import dask_scheduler, dask_workers


@contextmanager
def engine_of(name: str, pythons: Sequence[str], folder: Path) -> Iterator[Engine]:
    """Open the requested engine."""
    if not pythons and name.startswith("processes:"):
        yield Processes(int(name.removeprefix("processes:")))
        return
    with ExitStack() as stack:
        if pythons:
            name = stack.enter_context(dask_scheduler(folder))
            stack.enter_context(dask_workers(name, folder, pythons))
        yield stack.enter_context(cluster(name, insecure=not name.startswith("local:")))  # on this machine, for a test


def main() -> int:
    """Read options, run the tasks, and report the outcome."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--every", type=float, default=20.0, help="seconds between two kills")
    parser.add_argument("--engine", default="local:2")
    parser.add_argument("--python", action="append", default=[], help="of a worker; repeat it")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, engine_of(given.engine, given.python, Path(folder)) as engine:
        print(engine.place, flush=True)
        tell = partial(print, flush=True)
        outcome = perform_under_fire(engine, given.count, given.every, Path(folder), seed=given.seed, tell=tell)
    print(outcome)
    return 0 if outcome.is_good else 1


if __name__ == "__main__":
    sys.exit(main())
