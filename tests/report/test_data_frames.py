"""Tables of a performance as data frames."""

import sys
from types import ModuleType

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.metrics.dry_run import DryRun
from kinesic.report.run import Performance, performance_of


@pytest.fixture(scope="module")
def run(hurried: DryRun) -> Performance:
    return performance_of(hurried, seed=0)


@pytest.fixture(scope="module", autouse=True)
def pandas() -> ModuleType:
    return pytest.importorskip("pandas")


def test_motion_data_frame_has_a_row_per_command_and_a_column_per_hinge(run: Performance):
    frame = run.to_dataframe()
    assert frame.index.name == "time"
    assert np.array_equal(frame.index, run.measured.times)
    elbow = run.plan.setup.robot.skeleton.names.index("r_elbow_flexion")
    assert np.array_equal(frame["measured", "r_elbow_flexion"], run.measured.angles[:, elbow])
    planned = run.plan.trajectory.sample(run.measured.times)[0]
    assert np.allclose(frame["planned"], planned, atol=1e-9)
    assert list(frame.columns.levels[0].sort_values()) == sorted(
        ["requested", "planned", "setpoint", "measured", "velocity", "duty"]
    )


def test_sync_data_frame_has_requested_planned_and_performed_times(run: Performance):
    frame = run.to_dataframe("syncs").set_index(["behaviour", "sync"])
    nod = run.syncs["nod:stroke"]
    assert frame.loc[("nod", "stroke"), "planned"] == nod.planned
    assert frame.loc[("nod", "stroke"), "performed"] == nod.performed
    rushed = run.syncs["rushed:start"]
    assert frame.loc[("rushed", "start"), "requested"] == rushed.requested
    assert frame["is_stroke"].sum() == sum(sync.is_stroke for sync in run.syncs)


def test_dropped_behaviour_has_nan_times_in_the_data_frame(run: Performance):
    frame = run.to_dataframe("behaviours")
    assert frame.loc["odd", "outcome"] == "dropped"
    assert np.isnan(frame.loc["odd", "start"])
    assert 0.0 <= frame.loc["nod", "start"] < frame.loc["nod", "end"]


def test_data_frame_of_checks_equals_the_checks_of_the_performance(run: Performance):
    frame = run.to_dataframe("checks")
    assert list(frame.index) == [check.name for check in run.checks]
    assert frame.loc["limits.speed", "value"] == next(c.value for c in run.checks if c.name == "limits.speed")


def test_error_for_an_unknown_data_frame_suggests_a_similar_name(run: Performance):
    with pytest.raises(ConfigError, match="no table 'sync'; did you mean syncs"):
        run.to_dataframe("sync")


def test_data_frame_of_servos_needs_a_performance_on_servos(run: Performance):
    with pytest.raises(ConfigError, match="on='servos'"):
        run.to_dataframe("servos")


def test_missing_pandas_is_named_with_its_extra(run: Performance, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ConfigError, match=r'pandas: .*pip install .*"kinesic\[notebook\]"'):
        run.to_dataframe()
