from contextlib import nullcontext
from functools import partial

import pytest

from kinesic.bench import cluster
from kinesic.tasks.engine import Processes


@pytest.fixture(autouse=True)
def few_ignored_tasks(monkeypatch):
    """Exclude only the last two tasks from the measured throughput."""
    monkeypatch.setattr(cluster, "IGNORED_TAIL_TASKS", 2)


def test_cluster_benchmark_separates_task_time_from_overhead():
    result = cluster.measure_throughput(Processes(1), cluster._prepare, [f"0.{number}" for number in range(80, 86)], 1)
    assert result.rate > 0
    assert result.work > 0.005
    assert 0 < result.caller < result.work
    assert 0 < result.startup < 5


def test_failed_benchmark_task_raises_an_error_with_its_reason():
    with pytest.raises(RuntimeError, match=r"tomorrow: .*ValueError"):
        cluster.measure_throughput(Processes(1), partial(partial, int), ["tomorrow"], 1)


@pytest.mark.soak
def test_both_task_engines_have_throughput_metrics(monkeypatch):
    monkeypatch.setattr(cluster, "TASKS_PER_WORKER", 4)
    monkeypatch.setattr(cluster, "MEASUREMENT_ROUNDS", 1)
    monkeypatch.setattr(cluster, "EMPTY_TASKS", 20)
    monkeypatch.setattr(cluster, "_prepare", cluster._idle)
    monkeypatch.setattr(cluster, "_open_dask", lambda count: nullcontext(Processes(count)))
    monkeypatch.setattr(cluster.os, "cpu_count", lambda: 2)
    metrics = {metric.name: metric for metric in cluster.bench()}
    for engine in ("processes", "dask"):
        assert metrics[f"cluster.{engine}.1.efficiency"].value == 1.0
        assert metrics[f"cluster.{engine}.2.efficiency"].goal == 0.9
        assert metrics[f"cluster.{engine}.empty_caller"].value > 0
    assert metrics["cluster.dask.begin_afresh"].value > 0.3
