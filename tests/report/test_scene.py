import sys

import pytest

from kinesic.body.robot import Robot
from kinesic.report.scene import drawable, scene_data

HUMAN = Robot.load("human")


@pytest.fixture
def without_scipy(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)


def test_robot_with_skin_keeps_its_skin_if_scipy_is_installed():
    assert drawable(HUMAN) is HUMAN


def test_capsules_and_a_face_screen_replace_the_skin_without_scipy(without_scipy):
    assert drawable(HUMAN).skin is None
    drawn = scene_data(HUMAN)
    assert "skin" not in drawn
    assert drawn["screen"] is not None
    assert len(drawn["segments"]) == len(HUMAN.skeleton.segments)


def test_robot_without_skin_is_unchanged_if_scipy_is_missing(without_scipy):
    robot = Robot.load("upper22")
    assert drawable(robot) is robot
