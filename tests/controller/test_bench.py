import json

import pytest

from kinesic.controller.bench import plan, twin
from kinesic.controller.bench.figure import Figure
from kinesic.controller.cli.bench import bench


@pytest.fixture
def brief(monkeypatch):
    """Two repetitions are enough to see that the figures are there."""
    monkeypatch.setattr(plan, "REPETITIONS", 2)
    monkeypatch.setattr(twin, "REPETITIONS", 2)


def test_a_figure_knows_whether_its_goal_is_met():
    assert Figure("x", 2.0, "ms", 3.0, "lower").ok is True
    assert Figure("x", 2.0, "x", 3.0, "higher").ok is False
    assert Figure("x", None, "x", 3.0, "higher", why="no OpenGL").ok is None


def test_plan_has_its_figures_and_no_violation(brief):
    figures = {figure.name: figure for figure in plan.bench()}
    assert figures["plan.full_5s_p95"].value > 0
    assert figures["plan.violations"].value == 0


def test_twin_measures_speed_tracking_and_clearance(brief):
    figures = {figure.name: figure for figure in twin.bench()}
    assert figures["twin.real_time"].value > 1
    assert figures["twin.rmse_nominal"].ok
    assert figures["twin.rmse_nominal"].value < figures["twin.rmse_pessimistic"].value
    assert figures["twin.clearance"].ok


def test_json_is_a_list_of_figures(brief, monkeypatch, capsys):

    bench.main(["plan", "--json"], standalone_mode=False)
    entries = json.loads(capsys.readouterr().out)
    assert {"name", "value", "unit", "goal", "better", "ok"} <= entries[0].keys()
