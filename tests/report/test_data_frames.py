"""Tables of a performance as data frames."""

import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.metrics.dry_run import DryRun
from kinesic.report.data_frames import make_data_frame
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


def test_data_frame_of_sync_points_has_requested_and_planned_and_performed_times(run: Performance):
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


def test_servo_data_frame_of_a_run_without_servos_raises_an_error(run: Performance):
    with pytest.raises(ConfigError, match="on='servos'"):
        run.to_dataframe("servos")


def test_error_for_missing_pandas_names_the_extra_that_installs_it(run: Performance, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ConfigError, match=r'pandas: .*pip install .*"kinesic\[notebook\]"'):
        run.to_dataframe()


def test_motion_data_frame_has_each_quantity_of_the_twin(run: Performance):
    frame, measured, desired = run.to_dataframe(), run.measured, run.plan.desired
    zero = run.plan.trajectory.zero
    expected = {
        "requested": desired.sample(measured.times - zero + desired.zero)[0],
        "setpoint": measured.setpoints,
        "measured": measured.angles,
        "velocity": measured.velocities,
        "duty": measured.duties,
    }
    for quantity, rows in expected.items():
        np.testing.assert_allclose(frame[quantity], rows, atol=1e-12)
    assert list(frame.columns.names) == ["quantity", "hinge"]


def test_servo_data_frame_has_a_row_per_reading(run: Performance):
    times = np.array([0.0, 0.5, 1.25])
    planned = run.plan.trajectory.sample(times)[0]
    servos = SimpleNamespace(times=times, setpoints=planned + 1.0, interpolated_angles=planned + 2.0)
    frame = make_data_frame(SimpleNamespace(plan=run.plan, servos=servos), "servos")
    assert list(frame.index) == times.tolist()
    for k, quantity in enumerate(("planned", "setpoint", "measured")):
        np.testing.assert_allclose(frame[quantity], planned + k, atol=1e-12)


def test_behaviour_data_frame_has_first_and_last_sync_time(run: Performance):
    frame = run.to_dataframe("behaviours")
    for behaviour in ("nod", "rushed"):
        times = [sync.planned for sync in run.plan.syncs if sync.behaviour == behaviour]
        assert (frame.loc[behaviour, "start"], frame.loc[behaviour, "end"]) == (min(times), max(times))
    rows = {row["id"]: row for row in run.data["behaviours"]}
    for column in ("name", "type", "outcome", "why", "reason"):
        assert frame[column].to_dict() == {id: row[column] for id, row in rows.items()}
