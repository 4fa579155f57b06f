"""Robot of LeRobot's interface that moves a twin, or servos."""

import threading
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot as Model
from kinesic.hardware.protocol.wire import BusError

from .lerobot import PLUGIN_FOLDER, RobotConfig, provided_lerobot

with provided_lerobot():
    import lerobot_robot_kinesic.kinesic_robot as module
    from lerobot_robot_kinesic import KinesicRobot, KinesicRobotConfig
    from lerobot_robot_kinesic.follower import TICK, Follower

MODEL = Model.load("op3")
RENAMED = """
[robot]
name = "mine"
extends = "op3"
[[hinge]]
name = "skullbase_torsion"
source = { joint = "head_pan", sign = -1, zero_deg = 90 }
"""


@pytest.fixture
def renamed(tmp_path: Path) -> Path:
    """Robot whose first joint has another name, direction and zero in its own file."""
    path = tmp_path / "mine.toml"
    path.write_text(RENAMED, encoding="utf-8")
    return path


@pytest.fixture
def robot(renamed: Path) -> Iterator[KinesicRobot]:
    """Connected robot whose twin moves."""
    connected = KinesicRobot(KinesicRobotConfig(robot=str(renamed), velocity=1.0))
    connected.connect()
    yield connected
    connected.disconnect()


def angles_after(follower: Follower, seconds: float) -> np.ndarray:
    return np.array([command.angles for command in follower.commands(seconds)])


@pytest.mark.parametrize("distance", [0.001, 0.05, 1.0])
def test_hinge_reaches_its_target_within_limits_without_passing_it(distance: float):
    follower = Follower(MODEL, 0.5)
    rest = follower.target.copy()
    follower.aim(rest + distance * (np.arange(8) == 0))
    commands = list(follower.commands(4.0))
    turns = np.array([command.angles[0] - rest[0] for command in commands])
    rates = np.array([command.velocities[0] for command in commands])
    limit = 0.5 * MODEL.velocity_limits[0]
    assert turns[-1] == pytest.approx(distance, abs=1e-4)
    assert turns.max() <= distance + 1e-4
    assert rates.max() <= limit + 1e-9
    assert np.abs(np.diff(rates)).max() <= limit / 0.25 * TICK + 1e-9
    assert turns[1:] == pytest.approx(np.cumsum(rates)[1:] * TICK, abs=1e-9)


def test_target_beyond_a_range_is_clipped_and_the_joint_stays_inside():
    follower = Follower(MODEL, 1.0)
    assert follower.aim(np.full(8, 99.0)).tolist() == MODEL.skeleton.upper.tolist()
    assert (angles_after(follower, 5.0) <= MODEL.skeleton.upper + 1e-12).all()


def test_commands_come_100_times_a_second_and_only_once():
    follower = Follower(MODEL, 0.5)
    times = [command.time for until in (0.0, 0.055, 0.05, 0.1) for command in follower.commands(until)]
    assert times == pytest.approx(np.arange(11) / 100)


def test_target_that_turns_back_keeps_the_limit_of_acceleration():
    follower = Follower(MODEL, 1.0)
    rest = follower.target.copy()
    follower.aim(rest + 1.0 * (np.arange(8) == 0))
    first = list(follower.commands(0.3))
    follower.aim(rest)
    rates = np.array([command.velocities[0] for command in [*first, *follower.commands(4.0)]])
    assert np.abs(np.diff(rates)).max() <= MODEL.velocity_limits[0] / 0.25 * TICK + 1e-9
    assert follower.target.tolist() == rest.tolist()


@pytest.mark.parametrize("target", [np.zeros(7), np.full(8, np.nan)])
def test_target_with_wrong_count_or_nan_is_refused(target: np.ndarray):
    with pytest.raises(ValueError, match="must be 8 finite numbers"):
        Follower(MODEL, 0.5).aim(target)


@pytest.mark.parametrize("velocity", [0.0, 1.5, float("nan")])
def test_fraction_of_velocity_outside_its_range_is_refused(velocity: float):
    with pytest.raises(ValueError, match=r"must be 0\.01 to 1"):
        Follower(MODEL, velocity)


def test_features_are_the_joints_of_the_robots_own_file_before_it_is_connected(renamed: Path):
    robot = KinesicRobot(KinesicRobotConfig(robot=str(renamed)))
    assert list(robot.observation_features)[:2] == ["head_pan.pos", "skullbase_tilt.pos"]
    assert robot.action_features == robot.observation_features
    assert set(robot.action_features.values()) == {float}
    assert not robot.is_connected
    assert robot.is_calibrated


def test_twin_moves_to_the_clipped_action_in_degrees(robot: KinesicRobot):
    sent = robot.send_action({"head_pan.pos": 80.0, "l_shoulder_abduct.pos": -50.0})
    assert sent["head_pan.pos"] == pytest.approx(80.0)
    assert sent["l_shoulder_abduct.pos"] == pytest.approx(0.0)
    deadline = time.monotonic() + 30.0
    while abs(robot.get_observation()["head_pan.pos"] - 80.0) > 1.0 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert robot.get_observation()["head_pan.pos"] == pytest.approx(80.0, abs=1.0)
    assert list(robot.get_observation()) == list(robot.observation_features)


def test_unknown_joint_of_an_action_is_refused_with_the_known_joints(robot: KinesicRobot):
    with pytest.raises(ValueError, match="mine has no joint 'elbow'; its joints: head_pan"):
        robot.send_action({"elbow.pos": 1.0})


def test_disconnected_robot_refuses_actions_and_connects_again(robot: KinesicRobot):
    with pytest.raises(ConnectionError, match="already connected"):
        robot.connect()
    robot.disconnect()
    for use in (robot.get_observation, lambda: robot.send_action({})):
        with pytest.raises(ConnectionError, match="call connect first"):
            use()
    robot.connect()
    assert robot.is_connected


def test_failure_of_the_servos_is_reported_by_the_next_action(monkeypatch: pytest.MonkeyPatch):
    failed = threading.Event()

    class FailingServos:
        def __init__(self, model: Model, ports: dict[str, str]) -> None:
            self.ports = ports

        def write(self, command: object) -> None:
            failed.set()
            raise BusError("the supervisor has ended")

        def close(self) -> None:
            """Release nothing."""

    monkeypatch.setattr(module, "Servos", FailingServos)
    robot = KinesicRobot(KinesicRobotConfig(robot="op3", ports={"body": "/dev/x"}))
    robot.connect()
    assert failed.wait(30.0)
    robot._thread.join()
    with pytest.raises(ConnectionError, match="the supervisor has ended"):
        robot.send_action({})
    robot.disconnect()


def test_plugin_follows_the_naming_rules_of_lerobot():
    project = tomllib.loads((PLUGIN_FOLDER / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["name"].startswith("lerobot_robot_")
    assert RobotConfig.registry["kinesic"] is KinesicRobotConfig
    assert f"{KinesicRobot.__name__}Config" == KinesicRobotConfig.__name__
    assert KinesicRobot.config_class is KinesicRobotConfig
