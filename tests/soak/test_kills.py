"""Dry runs with workers killed at random times; `python -m tests.kills` has options."""

import pytest

from kinesic.tasks.cluster import cluster
from kinesic.tasks.engine import Processes

from ..kills.under_fire import perform_under_fire

pytestmark = [
    pytest.mark.soak,
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]
DOCUMENT_COUNT = 600
KILL_PERIOD = 4.0  # [s] mean time between two kills of a worker
MAX_MEMORY = 300.0  # [MB] largest memory of the calling process


def test_dry_runs_of_killed_worker_processes_are_neither_lost_nor_repeated(tmp_path):
    outcome = perform_under_fire(Processes(2), DOCUMENT_COUNT, KILL_PERIOD, tmp_path)
    assert outcome.is_good, outcome
    assert outcome.kills


def test_dry_runs_of_killed_dask_workers_are_neither_lost_nor_repeated(tmp_path):
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    with cluster("local:2") as engine:
        outcome = perform_under_fire(engine, DOCUMENT_COUNT, KILL_PERIOD, tmp_path)
    assert outcome.is_good, outcome
    assert outcome.kills
    assert outcome.memory <= MAX_MEMORY, outcome
