"""Tests of command times and of torques recomputed from measurements."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body import command as command_module
from kinesic.body.command import SETTLE_DURATION, Command, Measurements, Power, SetpointRows, State, command_times
from kinesic.body.robot import Robot

COMMAND_COUNT = 5  # number of commands


@pytest.mark.parametrize(
    ("duration", "rate", "settle", "count"),
    [(1.0, 10, 0.0, 11), (1.0, 10, 0.3, 14), (0.96, 10, 0.0, 11), (0.0, 10, 0.0, 1)],
)
def test_commands_cover_the_motion_and_its_settling_time(duration: float, rate: float, settle: float, count: int):
    times = command_times(duration, rate=rate, settle=settle)
    assert times.tolist() == pytest.approx([k / rate for k in range(count)])


def test_default_command_times_are_10_ms_apart_until_the_settling_time_ends():
    times = command_times(1.0)
    assert np.diff(times) == pytest.approx(0.01)
    assert times[-1] == pytest.approx(1.0 + SETTLE_DURATION)


def test_deprecated_names_speeds_and_goals_return_velocities_and_setpoints():
    vectors = [np.full(2, float(k)) for k in range(4)]
    command = Command(0.0, *vectors)
    assert command.speeds is command.velocities
    assert command.goals is command.setpoints
    assert State(*vectors[:3]).speeds is vectors[1]


def test_setpoints_stored_in_ticks_are_returned_as_read_only_radians():
    rows = SetpointRows(np.array([[1, 2], [3, 4], [5, 6]], dtype=np.int16), np.array([0.5, 2.0]))
    assert rows.angles().tolist() == [[0.5, 4.0], [1.5, 8.0], [2.5, 12.0]]
    assert rows.angles(slice(1, 2)).tolist() == [[1.5, 8.0]]
    assert not rows.angles().flags.writeable


@pytest.fixture
def measured() -> Measurements:
    robot = Robot.load()
    joints = len(robot.drives)
    rng = np.random.default_rng(1)
    angles, sent, in_force = rng.uniform(-0.2, 0.2, (3, COMMAND_COUNT, joints))
    one = np.ones(joints)
    empty = np.zeros(COMMAND_COUNT)
    return Measurements(
        times=np.arange(COMMAND_COUNT) / 100,
        angles=angles,
        velocities=rng.uniform(-1.0, 1.0, (COMMAND_COUNT, joints)),
        sent=SetpointRows(sent, one),
        in_force=SetpointRows(in_force, one),
        supplied=np.linspace(0.8, 1.0, COMMAND_COUNT),
        drives=robot.drives,
        hands={},
        clearance=None,
        latency=0.0,
        power=Power(empty, empty, 0.0, 12.0, {}),
    )


def test_duties_and_torques_follow_the_servo_model_of_the_setpoints_in_force(measured: Measurements):
    drives = measured.drives
    duties = drives.demanded_duties(measured.in_force.counts - measured.angles, measured.velocities)
    ratios = drives.torque_ratios(np.clip(duties, -1.0, 1.0), measured.velocities, measured.supplied)
    np.testing.assert_allclose(measured.duties, duties, rtol=1e-12)
    np.testing.assert_allclose(measured.torques, ratios * drives.stall, rtol=1e-12)
    assert np.abs(duties).max() > 1.0  # the torque uses the duty that a servo can reach
    assert measured.setpoints.tolist() == measured.sent.counts.tolist()
    assert not measured.duties.flags.writeable


def test_duties_and_torques_do_not_depend_on_the_batch_size_of_commands(
    measured: Measurements, monkeypatch: pytest.MonkeyPatch
):
    whole = measured.duties, measured.torques
    monkeypatch.setattr(command_module, "COMMANDS_PER_WINDOW", 2)
    assert [(rows.start, rows.stop) for rows in measured.windows()] == [(0, 2), (2, 4), (4, 6)]
    np.testing.assert_allclose(measured.duties, whole[0], rtol=1e-12)
    np.testing.assert_allclose(measured.torques, whole[1], rtol=1e-12)
    assert replace(measured, times=np.arange(4)).windows().__next__() == slice(0, 2)


def test_repr_of_measurements_contains_their_count_and_number_of_hinges(measured: Measurements):
    assert repr(measured) == f"<{COMMAND_COUNT} measurements of {measured.angles.shape[1]} hinges>"
