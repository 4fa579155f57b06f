"""Performance on a stand-in for the daemon of a Reachy Mini, with a clock that does not wait."""

from collections.abc import Iterator

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.reachy_mini.sink import ReachyMini

from .daemon import Daemon, running_daemon

ROBOT = Robot.load("upper22")
ZEROS = np.zeros(len(ROBOT.skeleton.names))


class Clock:
    """Clock that advances by sleeping alone."""

    time = 5.0

    def now(self) -> float:
        return self.time

    def sleep(self, duration: float) -> None:
        self.time += duration


@pytest.fixture
def daemon() -> Iterator[Daemon]:
    with running_daemon() as running:
        yield running


def command(time: float, yaw: float = 0.0) -> Command:
    angles = np.array(ROBOT.skeleton.rest)
    angles[ROBOT.skeleton.joint("skullbase_torsion")] = yaw
    return Command(time, angles, ZEROS, ZEROS, angles)


def perform(daemon: Daemon, *, seconds: float) -> tuple[ReachyMini, Clock]:
    """Send 100 commands per second, and close the sink."""
    clock = Clock()
    sink = ReachyMini(ROBOT, daemon.address, now=clock.now, sleep=clock.sleep)
    for k in range(round(100 * seconds)):
        sink.write(command(k / 100, yaw=k / 100))
    sink.close()
    return sink, clock


def test_motors_are_switched_on_and_the_robot_moves_to_the_first_pose_before_targets(daemon: Daemon):
    perform(daemon, seconds=0.1)
    (motors, _), (move, goal) = daemon.requests
    assert (motors, move) == ("/api/motors/set_mode/enabled", "/api/move/goto")
    assert goal["duration"] == 1.0
    assert goal["head_pose"]["yaw"] == pytest.approx(0.0)


def test_targets_are_sent_50_times_a_second_at_their_times(daemon: Daemon):
    sink, clock = perform(daemon, seconds=0.5)
    assert [target["target_head_pose"]["yaw"] for target in daemon.targets] == pytest.approx(np.arange(25) / 50)
    assert sink.sent_count == 25
    assert clock.time == pytest.approx(5.0 + 1.0 + 0.48)
    assert sink.refusals == []


def test_refused_targets_are_kept_with_the_reason_of_the_daemon(daemon: Daemon):
    daemon.refuses_all = True
    sink, _ = perform(daemon, seconds=1.0)
    assert 0 < len(sink.refusals) <= 20
    assert set(sink.refusals) == {"motors are off"}


def test_missing_daemon_is_reported_with_its_address():
    with pytest.raises(ConfigError, match=r"http://127.0.0.1:9: the daemon of the Reachy Mini refuses or does not"):
        ReachyMini(ROBOT, "http://127.0.0.1:9")


def test_daemon_that_ends_during_a_performance_is_reported(daemon: Daemon):
    daemon.hangs_up = True
    with pytest.raises(ConfigError, match="has gone"):
        perform(daemon, seconds=100.0)


@pytest.mark.parametrize("address", ["reachy-mini.local:8000", "file:///etc/passwd", "http://", ""])
def test_address_that_is_not_http_is_refused(address: str):
    with pytest.raises(ConfigError, match="must be an HTTP address"):
        ReachyMini(ROBOT, address)
