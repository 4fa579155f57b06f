"""Robots of the extra `robots` in the benchmark of captured motion."""

import pytest

from kinesic.bench.capture import imported_robots
from kinesic.body.config import ConfigError


def test_robot_without_its_file_is_reported_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr(imported_robots, "WHEEL_NAME", "no-such-distribution")
    with pytest.raises(ConfigError, match=r"no MJCF file of g1: .*robots"):
        imported_robots.load_imported("g1")


def test_imported_robot_has_the_joint_names_of_its_file():
    try:
        robot = imported_robots.load_imported("op3")
    except ConfigError as error:
        pytest.skip(str(error))
    assert "l_el" in robot.source_joints.names
