import json

import pytest
from PIL import Image

from kinesic.body.config import ConfigError
from kinesic.report.plots.results import CHECKS_QUERY, MAX_RATIO, METRICS_QUERY, draw_results
from kinesic.tasks.store import open_store

duckdb = pytest.importorskip("duckdb", reason="the extra store is not installed")

SWEEP_ROWS = [{"value": value, "swept_volume": 2 + value} for value in (-1.0, 1.0)]
SWEEP_SERIES = {"parameter": "spatial", "measure": "swept_volume", "played": SWEEP_ROWS}
BENCHMARK_METRIC = {"name": "a", "value": 2.0, "unit": "s", "goal": 1.0, "better": "lower", "why": "", "ok": False}
ROBOT_DESIGN = {"state": "finished", "price": 5.0, "lateness": 1.0, "mass": 4.0, "unbeaten": True, "changes": {}}
RESULT_FILES = {
    "sweep.json": {"gesture": "beat", "style": "calm", "series": [SWEEP_SERIES]},
    "bench.json": [BENCHMARK_METRIC],
    "designs.json": {
        "designs": [ROBOT_DESIGN | {"performed": []}, ROBOT_DESIGN | {"performed": [], "unbeaten": False}]
    },
}


def height(path) -> int:
    with Image.open(path) as picture:
        return picture.height


@pytest.mark.soak
def test_plot_of_results_grows_with_the_number_of_result_kinds(tmp_path):
    heights = []
    for name, data in RESULT_FILES.items():
        (tmp_path / name).write_text(json.dumps(data))
        with open_store(tmp_path) as store:
            draw_results(store, tmp_path / "results.png")
        heights.append(height(tmp_path / "results.png"))
    assert heights[0] < heights[1] < heights[2]


def test_error_names_a_result_table_that_cannot_be_plotted(tmp_path):
    duckdb.sql("SELECT 1 AS x").write_parquet(str(tmp_path / "mine.parquet"))
    with open_store(tmp_path) as store, pytest.raises(ConfigError, match="no picture of mine is known, of checks"):
        draw_results(store, tmp_path / "results.png")


def test_violated_minimum_checks_have_ratios_above_one_in_the_result_plot(tmp_path):
    entries = [
        {"name": "collision.twin", "status": "fail", "value": 0.005, "limit": 0.01, "unit": "m", "where": ""},
        {"name": "meaning.performed", "status": "pass", "value": 1.0, "limit": 0.5, "unit": "ratio", "where": ""},
        {"name": "collision.performed", "status": "fail", "value": -1.0, "limit": 0.9, "unit": "ratio", "where": ""},
        {"name": "limits.speed", "status": "fail", "value": 1.5, "limit": 1.0, "unit": "ratio", "where": ""},
    ]
    entry = {"file": "a.bml", "outcome": "performed", "exit": 1, "behaviours": [], "checks": entries, "error": ""}
    (tmp_path / "finished.jsonl").write_text(json.dumps({"key": "1", "entry": entry}) + "\n")
    figure = BENCHMARK_METRIC | {"goal": 4.0, "better": "higher"}
    (tmp_path / "bench.json").write_text(json.dumps([figure, BENCHMARK_METRIC | {"name": "b"}]))
    with open_store(tmp_path) as store:
        ratios = {row[0]: row[4] for row in store.ask(CHECKS_QUERY).rows}
        figures = {row[0]: row[1] for row in store.ask(METRICS_QUERY).rows}
    assert ratios == pytest.approx(
        {"meaning.performed": 0.5, "limits.speed": 1.5, "collision.twin": 2.0, "collision.performed": MAX_RATIO}
    )
    assert figures == pytest.approx({"a": 2.0, "b": 2.0})
