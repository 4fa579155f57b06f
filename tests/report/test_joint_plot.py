"""Plot of a performance with matplotlib."""

import sys
from collections.abc import Iterator

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.metrics.dry_run import DryRun
from kinesic.report.run import Performance, performance_of


@pytest.fixture(scope="module")
def run(hurried: DryRun) -> Performance:
    return performance_of(hurried, seed=0)


@pytest.fixture(autouse=True)
def canvas() -> Iterator[None]:
    """Draw without a display, and close all figures afterwards."""
    pytest.importorskip("matplotlib").use("Agg")
    yield
    pytest.importorskip("matplotlib.pyplot").close("all")


def test_named_joint_has_a_panel_with_requested_planned_and_measured_curves(run: Performance):
    _, panel = run.plot(["r_elbow_flexion"])
    elbow = run.plan.setup.robot.skeleton.names.index("r_elbow_flexion")
    curves = {line.get_label(): line.get_ydata() for line in panel.lines}
    assert np.array_equal(curves["measured"], np.degrees(run.measured.angles[:, elbow]))
    assert np.allclose(curves["planned"], np.degrees(run.plan.trajectory.sample(run.measured.times)[0][:, elbow]))
    assert not np.allclose(curves["requested"], curves["planned"], atol=0.1)


def test_joint_plot_shows_the_four_joints_that_move_most_by_default(run: Performance):
    names = run.plan.setup.robot.skeleton.names
    travels = dict(zip(names, np.ptp(run.measured.angles, axis=0), strict=True))
    shown = [panel.get_title(loc="left") for panel in run.plot()[1:]]
    assert set(shown) == set(sorted(travels, key=lambda name: -travels[name])[:4])


def test_timeline_of_the_joint_plot_names_behaviours_and_words(run: Performance):
    timeline = run.plot([])[0]
    rows = [label.get_text() for label in timeline.get_yticklabels()]
    assert {"offer", "NOD", "speech"} <= set(rows)
    assert any("Hello" in text.get_text() for text in timeline.texts)


def test_error_for_an_unknown_joint_suggests_a_similar_name(run: Performance):
    with pytest.raises(ConfigError, match="no hinge r_elbow_flex; did you mean r_elbow_flexion"):
        run.plot(["r_elbow_flex"])


def test_error_for_missing_matplotlib_names_the_extra_that_installs_it(run: Performance, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ConfigError, match=r'pip install .*"kinesic\[notebook\]"'):
        run.plot()
