import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic import cli
from kinesic.bench import plan, twin
from kinesic.bench.blocks import corpus_folder, crowd, plan_corpus
from kinesic.bench.figure import Figure
from kinesic.bench.plan import first_command
from kinesic.body.config import ConfigError
from kinesic.cli import bench
from kinesic.controller.perform import set_up

KINDS = ("", "_feedforward_only", "_without")  # of the twin's helps
SMALL = 8  # the seed of a crowded block whose optimum is soon found


@pytest.fixture
def brief(monkeypatch):
    """One or two repetitions are enough to see that the figures are there."""
    monkeypatch.setattr(plan, "REPETITIONS", 1)
    monkeypatch.setattr(plan, "CROWDS", 1)
    monkeypatch.setattr(plan, "THRONGED", 1)
    monkeypatch.setattr(plan, "RHYTHMS", 1)
    cost = plan.hostile.Cost(
        0.5, 80.0, "realised 1"
    )  # measured in a process of its own: tests/bench/plan/test_hostile.py
    monkeypatch.setattr(plan.hostile, "measure_plan", lambda name: cost)
    monkeypatch.setattr(plan, "crowd", lambda seed, lexemes: crowd(SMALL + seed, lexemes))
    monkeypatch.setattr(first_command, "REPETITIONS", 2)
    monkeypatch.setattr(twin, "REPETITIONS", 2)
    monkeypatch.setattr(twin, "BLOCKS", 2)
    monkeypatch.setattr(twin, "WRONG", twin.WRONG[:1])
    monkeypatch.setattr(twin, "TOGETHER", twin.TOGETHER[:1])


def test_a_figure_knows_whether_its_goal_is_met():
    assert Figure("x", 2.0, "ms", 3.0, "lower").ok is True
    assert Figure("x", 2.0, "x", 3.0, "higher").ok is False
    assert Figure("x", None, "x", 3.0, "higher", why="no OpenGL").ok is None


def test_plan_has_its_figures_and_no_violation(brief):
    figures = {figure.name: figure for figure in plan.bench()}
    assert figures["plan.full_5s_p95"].value > 0
    assert all(figures[f"plan.cpu_{name}"].value > 0 for name in ("asked", "moved", "repeated", "crowded", "hostile"))
    assert figures["plan.memory_hostile"].value == 80.0
    assert figures["plan.violations"].value == 0
    assert figures["plan.stretch_blocks"].value == 2
    assert figures["plan.stretch"].ok
    assert figures["plan.stretch_worst"].value <= 1.25


def test_twin_measures_speed_and_clearance(brief, monkeypatch):
    monkeypatch.setattr(twin, "TOGETHER", ())
    monkeypatch.setattr(twin, "HELPS", twin.HELPS[1:2])  # identification takes seconds, and has tests of its own
    monkeypatch.setattr(twin, "BLOCKS", 1)
    figures = {figure.name: figure for figure in twin.bench()}
    assert figures["twin.real_time"].value > 1
    assert figures["twin.clearance"].ok


@pytest.mark.skipif(corpus_folder() is None, reason="no corpus of BML documents (KINESIC_CORPUS)")
def test_feed_forward_and_correction_each_bring_servos_nearer_to_the_plan(brief, monkeypatch):
    for wrong in ("WRONG", "TOGETHER"):
        monkeypatch.setattr(twin, wrong, ())  # nothing is asked of them here
    known = [replace(given, identifies=False) for given in twin.HELPS if given.suffix in KINDS]
    monkeypatch.setattr(twin, "HELPS", known)
    figures = {figure.name: figure for figure in twin.tracking_figures(set_up(), 3)}
    for twin_name in ("nominal", "pessimistic"):
        helped, alone, without = (figures[f"twin.rmse_{twin_name}{kind}"].value for kind in KINDS)
        assert helped < alone < without
    assert figures["twin.rmse_nominal"].ok
    assert figures["twin.rmse_pessimistic_without"].ok is None


def test_without_a_corpus_the_table_is_null_and_says_why(monkeypatch):
    monkeypatch.setenv("KINESIC_CORPUS", "nowhere")
    figures = twin.tracking_figures(set_up())
    assert len(figures) == 8 * (2 * (2 + len(twin.WRONG) + len(twin.TOGETHER)) + 4)
    assert all(figure.value is None and "KINESIC_CORPUS" in figure.why for figure in figures)


def test_the_choice_of_documents_is_the_same_each_time():
    where = corpus_folder()
    if where is None:
        pytest.skip("no corpus of BML documents (KINESIC_CORPUS)")
    known = set_up()
    first, again = (plan_corpus(where, known, 2) for _ in range(2))
    assert [plan.timeline.block.id for plan in first] == [plan.timeline.block.id for plan in again]


def test_the_first_command_has_its_figures(brief):
    figures = {figure.name: figure for figure in first_command.bench()}
    assert 0 < figures["plan.first_command_median"].value <= figures["plan.first_command_p95"].value
    assert np.isfinite(figures["plan.taken_over"].value)


def test_json_is_a_list_of_figures(monkeypatch, capsys):
    monkeypatch.setattr(bench, "measure", lambda part, stage: [Figure(f"{part}.x", 2.0, "ms", 3.0, "lower")])
    cli.kinesic.main(["bench", "plan", "--json"], standalone_mode=False)
    entries = json.loads(capsys.readouterr().out)
    assert {"name", "value", "unit", "goal", "better", "ok"} <= entries[0].keys()


def test_figures_are_kept_for_results(monkeypatch, capsys, tmp_path):
    figures = [Figure("a.x", 2.0, "ms", 3.0, "lower"), Figure("a.y", None, "ms", None, "lower", "no GPU")]
    monkeypatch.setattr(bench, "measure", lambda part, stage: figures)
    monkeypatch.chdir(tmp_path)
    cli.kinesic.main(["bench", "plan", "--out", "kept"], standalone_mode=False)
    assert "json: kept/bench.json" in capsys.readouterr().out
    assert [row["ok"] for row in json.loads((tmp_path / "kept" / "bench.json").read_text())] == [True, None]
    with pytest.raises(ConfigError, match="kept"):
        cli.kinesic.main(["bench", "plan", "--out", "kept"], standalone_mode=False)


def test_what_is_measured_is_told_meanwhile(monkeypatch):
    told = []
    monkeypatch.setattr(bench, "import_module", lambda name: SimpleNamespace(bench=lambda: [name, *told]))
    found = bench.measure("plan", told.append)
    assert found == [
        *("kinesic.bench.plan.first_command", "measuring plan.first_command"),
        *("kinesic.bench.plan", "measuring plan.first_command", "measuring plan"),
    ]
