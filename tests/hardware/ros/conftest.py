"""Robot with joint names of its own, behind a stand-in for rosbridge."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot as Model
from kinesic.hardware.ros.joints import RosJoints

from .rosbridge import Robot, running_bridge

TABLES = """
[robot]
name = "mine"
extends = "op3"
[[hinge]]
name = "skullbase_torsion"
source = { joint = "head_pan", sign = -1, zero_deg = 90 }
"""  # a robot whose first joint has another name, direction and zero in its own file


class Clock:
    """Clock that advances by sleeping alone."""

    time = 5.0

    def now(self) -> float:
        return self.time

    def sleep(self, duration: float) -> None:
        self.time += duration


@pytest.fixture(scope="session")
def joints(tmp_path_factory: pytest.TempPathFactory) -> RosJoints:
    """All joints of the robot."""
    path = tmp_path_factory.mktemp("ros") / "mine.toml"
    path.write_text(TABLES, encoding="utf-8")
    return RosJoints.of(Model.load(path))


@pytest.fixture
def robot(joints: RosJoints) -> Robot:
    """Robot in its rest posture."""
    rest = joints.positions(joints.robot.skeleton.rest)
    return Robot(dict(zip(joints.names, rest.tolist(), strict=True)))


@pytest.fixture
def address(robot: Robot) -> Iterator[str]:
    """Address of a running stand-in for rosbridge."""
    with running_bridge(robot) as place:
        yield place


@pytest.fixture
def command(joints: RosJoints) -> Callable[..., Command]:
    """Function that returns a command whose first hinge is turned from the rest posture."""
    rest = joints.robot.skeleton.rest

    def make(time: float, *, turn: float = 0.0, velocity: float = 0.0) -> Command:
        first = np.eye(len(rest))[0]
        angles = rest + turn * first
        return Command(time, angles, velocity * first, 3.0 * first, angles)

    return make
