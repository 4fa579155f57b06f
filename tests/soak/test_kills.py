"""Dry runs with workers killed at random times; `python -m tests.kills` has options."""

import pytest

from kinesic.tasks.cluster import cluster
from kinesic.tasks.engine import Processes

from ..kills.under_fire import perform_under_fire

pytestmark = [
    pytest.mark.soak,
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]
COUNT, EVERY = 600, 4.0  # [s] between two kills
MOST = 300.0  # [MB] of who called


def test_dry_runs_of_killed_worker_processes_are_neither_lost_nor_repeated(tmp_path):
    outcome = perform_under_fire(Processes(2), COUNT, EVERY, tmp_path)
    assert outcome.is_good, outcome
    assert outcome.kills


def test_dry_runs_of_killed_dask_workers_are_neither_lost_nor_repeated(tmp_path):
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    with cluster("local:2") as engine:
        outcome = perform_under_fire(engine, COUNT, EVERY, tmp_path)
    assert outcome.is_good, outcome
    assert outcome.kills
    assert outcome.memory <= MOST, outcome
