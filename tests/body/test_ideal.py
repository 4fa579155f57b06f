import numpy as np
import pytest

from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.ideal import ideal
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Hinge

DOWN = np.array([0.0, 0, -0.3])


def hinge(name, *axis):
    return Hinge(name, "s", np.array(axis, dtype=float) / np.linalg.norm(axis), -1.0, 1.0, 0.0)


def chain(*hinges):
    shoulder = ChainJoint("shoulder", hinges, DOWN)
    elbow = ChainJoint("elbow", (hinge("bend", 0, -1, 0),), DOWN)
    wrist = ChainJoint("wrist", (), DOWN)
    indices = tuple(range(3, 4 + len(hinges)))
    return Chain("arm", "base", np.zeros(3), (shoulder, elbow, wrist), indices, np.array([0.0, 1, 0]))


def test_the_default_robot_is_ideal():
    robot = Robot.load()
    for side in ("l", "r"):
        assert robot.arms[side].indices == robot.joints(f"{side}_arm")
        assert ideal(robot.arms[side]) is robot.arms[side]


def test_a_twist_near_its_bone_comes_to_lie_along_it():
    found = ideal(chain(hinge("a", 0, 1, 0), hinge("b", 1, 0, 0), hinge("c", 0.1, 0.1, 1)))
    assert found.joints[0].hinges[2].axis == pytest.approx([0, 0, 1])
    assert found.joints[0].hinges[2].name == "c"
    assert found.indices == (3, 4, 5, 6)


def test_one_hinge_too_many_is_left_out():
    found = ideal(chain(hinge("a", 1, 0, 0), hinge("b", 0, 0.1, 1), hinge("c", 0, 1, 0)))
    assert [h.name for h in found.joints[0].hinges] == ["a", "c"]
    assert found.indices == (3, 5, 6)


def test_two_swings_stay():
    plain = chain(hinge("a", 0, 1, 0.3), hinge("b", 1, 0, 0))
    assert ideal(plain) is plain
