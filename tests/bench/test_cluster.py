from contextlib import nullcontext
from functools import partial

import pytest

from kinesic.bench import cluster
from kinesic.tasks.engine import Processes


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Counts almost all of a few tasks."""
    monkeypatch.setattr(cluster, "TAIL", 2)


def test_a_pace_counts_work_and_what_is_beside_it():
    found = cluster.pace(Processes(1), cluster._prepare, [f"0.{number}" for number in range(80, 86)], 1)
    assert found.rate > 0
    assert found.work > 0.005
    assert 0 < found.caller < found.work
    assert 0 < found.ready < 5


def test_a_task_that_fails_ends_it():
    with pytest.raises(RuntimeError, match=r"tomorrow: .*ValueError"):
        cluster.pace(Processes(1), partial(partial, int), ["tomorrow"], 1)


def test_both_engines_have_their_figures(monkeypatch):
    monkeypatch.setattr(cluster, "SHARE", 4)
    monkeypatch.setattr(cluster, "ROUNDS", 1)
    monkeypatch.setattr(cluster, "EMPTY", 20)
    monkeypatch.setattr(cluster, "_prepare", cluster._idle)
    monkeypatch.setattr(cluster, "_dask", lambda count: nullcontext(Processes(count)))
    monkeypatch.setattr(cluster.os, "cpu_count", lambda: 2)
    figures = {figure.name: figure for figure in cluster.bench()}
    for engine in ("processes", "dask"):
        assert figures[f"cluster.{engine}.1.efficiency"].value == 1.0
        assert figures[f"cluster.{engine}.2.efficiency"].goal == 0.9
        assert figures[f"cluster.{engine}.empty_caller"].value > 0
    assert figures["cluster.dask.begin_afresh"].value > 0.3
