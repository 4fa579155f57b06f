import json

import pytest
from PIL import Image

from kinesic.body.config import ConfigError
from kinesic.report.plots.results import draw_results
from kinesic.tasks.store import open_store

duckdb = pytest.importorskip("duckdb", reason="the extra store is not installed")

PLAYED = [{"value": value, "swept_volume": 2 + value} for value in (-1.0, 1.0)]
SERIES = {"parameter": "spatial", "measure": "swept_volume", "played": PLAYED}
FIGURE = {"name": "a", "value": 2.0, "unit": "s", "goal": 1.0, "better": "lower", "why": "", "ok": False}
DESIGN = {"state": "finished", "price": 5.0, "lateness": 1.0, "mass": 4.0, "unbeaten": True, "changes": {}}
RUNS = {
    "sweep.json": {"gesture": "beat", "style": "calm", "series": [SERIES]},
    "bench.json": [FIGURE],
    "designs.json": {"designs": [DESIGN | {"performed": []}, DESIGN | {"performed": [], "unbeaten": False}]},
}


def height(path) -> int:
    with Image.open(path) as picture:
        return picture.height


def test_each_kind_of_results_has_a_panel(tmp_path):
    heights = []
    for name, data in RUNS.items():
        (tmp_path / name).write_text(json.dumps(data))
        with open_store(tmp_path) as store:
            draw_results(store, tmp_path / "results.png")
        heights.append(height(tmp_path / "results.png"))
    assert heights[0] < heights[1] < heights[2]


def test_tables_of_which_no_picture_is_known_say_so(tmp_path):
    duckdb.sql("SELECT 1 AS x").write_parquet(str(tmp_path / "mine.parquet"))
    with open_store(tmp_path) as store, pytest.raises(ConfigError, match="no picture of mine is known, of checks"):
        draw_results(store, tmp_path / "results.png")
