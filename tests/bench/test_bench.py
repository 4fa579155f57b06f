import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic import cli
from kinesic.bench import plan, twin
from kinesic.bench.blocks import find_corpus, plan_corpus, write_overlapping_block
from kinesic.bench.metric import Metric
from kinesic.bench.plan import first_command
from kinesic.body.config import ConfigError
from kinesic.cli import bench
from kinesic.session.setup import set_up

AID_SUFFIXES = ("", "_feedforward_only", "_without")  # twin metrics with both servo aids, with one, with none
QUICK_SEED = 8  # random seed of an overlapping block whose optimum is found quickly


@pytest.fixture
def few_repetitions(monkeypatch):
    """Reduce the repetitions of all measurements to one or two."""
    monkeypatch.setattr(plan, "PASSAGE_REPETITIONS", 1)
    monkeypatch.setattr(plan, "CROWDED_BLOCKS", 1)
    monkeypatch.setattr(plan, "CPU_BLOCKS", 1)
    monkeypatch.setattr(plan, "REPEATED_BLOCKS", 1)
    cost = plan.hostile.PlanningCost(
        0.5, 80.0, "realised 1"
    )  # measured in its own process, see tests/bench/plan/test_hostile.py
    monkeypatch.setattr(plan.hostile, "measure_hostile_plan", lambda name: cost)
    monkeypatch.setattr(
        plan, "write_overlapping_block", lambda seed, lexemes: write_overlapping_block(QUICK_SEED + seed, lexemes)
    )
    monkeypatch.setattr(first_command, "COMMAND_REPETITIONS", 2)
    monkeypatch.setattr(twin, "PASSAGE_RUNS", 2)
    monkeypatch.setattr(twin, "CORPUS_BLOCKS", 2)
    monkeypatch.setattr(twin, "DETUNED_TWINS", twin.DETUNED_TWINS[:1])
    monkeypatch.setattr(twin, "WORST_TWINS", twin.WORST_TWINS[:1])


def test_benchmark_metric_is_ok_if_its_value_meets_its_goal():
    assert Metric("x", 2.0, "ms", 3.0, "lower").ok is True
    assert Metric("x", 2.0, "x", 3.0, "higher").ok is False
    assert Metric("x", None, "x", 3.0, "higher", why="no OpenGL").ok is None


@pytest.mark.soak
def test_plan_benchmark_has_positive_times_and_no_limit_violations(few_repetitions):
    metrics = {metric.name: metric for metric in plan.bench()}
    assert metrics["plan.full_5s_p95"].value > 0
    assert all(metrics[f"plan.cpu_{name}"].value > 0 for name in ("asked", "moved", "repeated", "crowded", "hostile"))
    assert metrics["plan.memory_hostile"].value == 80.0
    assert metrics["plan.violations"].value == 0
    assert metrics["plan.stretch_blocks"].value == 2
    assert metrics["plan.stretch"].ok
    assert metrics["plan.stretch_worst"].value <= 1.25


def test_twin_benchmark_measures_speed_and_clearance(few_repetitions, monkeypatch):
    monkeypatch.setattr(twin, "WORST_TWINS", ())
    monkeypatch.setattr(
        twin, "TRACKING_AIDS", twin.TRACKING_AIDS[1:2]
    )  # identification takes seconds and is tested separately
    monkeypatch.setattr(twin, "CORPUS_BLOCKS", 1)
    metrics = {metric.name: metric for metric in twin.bench()}
    assert metrics["twin.real_time"].value > 1
    assert metrics["twin.clearance"].ok


@pytest.mark.soak
@pytest.mark.skipif(find_corpus() is None, reason="no corpus of BML documents (KINESIC_CORPUS)")
def test_feed_forward_and_setpoint_correction_each_reduce_the_tracking_error(few_repetitions, monkeypatch):
    for twins in ("DETUNED_TWINS", "WORST_TWINS"):
        monkeypatch.setattr(twin, twins, ())  # not needed here
    aids = [replace(aid, identifies=False) for aid in twin.TRACKING_AIDS if aid.suffix in AID_SUFFIXES]
    monkeypatch.setattr(twin, "TRACKING_AIDS", aids)
    metrics = {metric.name: metric for metric in twin.tracking_metrics(set_up(), 3)}
    for twin_name in ("nominal", "pessimistic"):
        corrected, feedforward, without = (metrics[f"twin.rmse_{twin_name}{kind}"].value for kind in AID_SUFFIXES)
        assert corrected < feedforward < without
    assert metrics["twin.rmse_nominal"].ok
    assert metrics["twin.rmse_pessimistic_without"].ok is None


def test_missing_corpus_gives_null_tracking_metrics_with_reason(monkeypatch):
    monkeypatch.setenv("KINESIC_CORPUS", "nowhere")
    metrics = twin.tracking_metrics(set_up())
    assert len(metrics) == 8 * (2 * (2 + len(twin.DETUNED_TWINS) + len(twin.WORST_TWINS)) + 4)
    assert all(metric.value is None and "KINESIC_CORPUS" in metric.why for metric in metrics)


def test_benchmark_chooses_the_same_corpus_documents_in_every_run():
    folder = find_corpus()
    if folder is None:
        pytest.skip("no corpus of BML documents (KINESIC_CORPUS)")
    setup = set_up()
    first, again = (plan_corpus(folder, setup, 2) for _ in range(2))
    assert [plan.timeline.block.id for plan in first] == [plan.timeline.block.id for plan in again]


def test_delay_from_document_to_first_servo_command_is_measured(few_repetitions):
    metrics = {metric.name: metric for metric in first_command.bench()}
    assert 0 < metrics["plan.first_command_median"].value <= metrics["plan.first_command_p95"].value
    assert np.isfinite(metrics["plan.taken_over"].value)


def test_bench_json_output_is_a_list_of_metrics(monkeypatch, capsys):
    monkeypatch.setattr(bench, "measure", lambda part, stage: [Metric(f"{part}.x", 2.0, "ms", 3.0, "lower")])
    cli.kinesic.main(["bench", "plan", "--json"], standalone_mode=False)
    entries = json.loads(capsys.readouterr().out)
    assert {"name", "value", "unit", "goal", "better", "ok"} <= entries[0].keys()


def test_benchmark_metrics_are_saved_to_an_output_folder(monkeypatch, capsys, tmp_path):
    metrics = [Metric("a.x", 2.0, "ms", 3.0, "lower"), Metric("a.y", None, "ms", None, "lower", "no GPU")]
    monkeypatch.setattr(bench, "measure", lambda part, stage: metrics)
    monkeypatch.chdir(tmp_path)
    cli.kinesic.main(["bench", "plan", "--out", "kept"], standalone_mode=False)
    assert "json: kept/bench.json" in capsys.readouterr().out
    assert [row["ok"] for row in json.loads((tmp_path / "kept" / "bench.json").read_text())] == [True, None]
    with pytest.raises(ConfigError, match="kept"):
        cli.kinesic.main(["bench", "plan", "--out", "kept"], standalone_mode=False)


def test_benchmark_progress_names_each_measured_module(monkeypatch):
    stages = []
    monkeypatch.setattr(bench, "import_module", lambda name: SimpleNamespace(bench=lambda: [name, *stages]))
    results = bench.measure("plan", stages.append)
    assert results == [
        *("kinesic.bench.plan.first_command", "measuring plan.first_command"),
        *("kinesic.bench.plan", "measuring plan.first_command", "measuring plan"),
        *("kinesic.bench.plan.styles", "measuring plan.first_command", "measuring plan", "measuring plan.styles"),
    ]
