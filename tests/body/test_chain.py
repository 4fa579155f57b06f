import numpy as np
import pytest

from kinesic.body.chain import Chain, ChainJoint, idealise
from kinesic.body.robot import Robot, Side
from kinesic.body.skeleton import Hinge

BONE_VECTOR = np.array([0.0, 0, -0.3])


@pytest.fixture(scope="module", params=["l", "r"])
def side(request: pytest.FixtureRequest) -> Side:
    return request.param


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load()


def test_arm_chain_contains_collar_bone_shoulder_elbow_and_wrist(robot: Robot, side: Side):
    arm = robot.arms[side]
    assert arm.base == "vt1"
    assert [joint.name for joint in arm.joints] == [
        f"{side}_{part}" for part in ("sternoclavicular", "shoulder", "elbow", "wrist")
    ]
    assert [len(joint.hinges) for joint in arm.joints] == [1, 3, 2, 2]


def test_chain_bones_have_the_lengths_of_the_robot_file(robot: Robot, side: Side):
    np.testing.assert_allclose(robot.arms[side].lengths, (0.115, 0.22, 0.20, 0.06), atol=1e-15)


def test_arm_limits_equal_those_of_the_skeleton(robot: Robot, side: Side):
    arm, skeleton = robot.arms[side], robot.skeleton
    indices = list(arm.indices)
    np.testing.assert_array_equal(arm.lower, skeleton.lower[indices])
    np.testing.assert_array_equal(arm.upper, skeleton.upper[indices])
    np.testing.assert_array_equal(arm.rest, skeleton.rest[indices])


def test_arm_chain_uses_the_wrist_as_hand_position_and_ends_at_the_palm(robot: Robot):
    arm = robot.arms["l"]
    _, centres = arm.frames(np.zeros(8))
    np.testing.assert_allclose(arm.hand(np.zeros(8)), (0, 0.155, -0.455), atol=1e-12)
    np.testing.assert_allclose(centres[-1], (0, 0.155, -0.515), atol=1e-12)


def test_palms_face_the_thighs_at_zero_angles(robot: Robot):
    assert robot.arms["l"].palm.tolist() == [0, -1, 0]
    assert robot.arms["r"].palm.tolist() == [0, 1, 0]


def test_kinematic_chain_from_the_root_segment_has_the_world_as_base(robot: Robot):
    palm = robot.sites["l_palm"]
    chain = Chain.of(robot.skeleton, "trunk", ("humanoid_root", "vl5"), along=palm.position, palm=palm.facing)
    assert chain.base == ""
    assert chain.indices == (0, 1, 2)


def hinge(name, *axis):
    return Hinge(name, "s", np.array(axis, dtype=float) / np.linalg.norm(axis), -1.0, 1.0, 0.0)


def chain(*hinges):
    shoulder = ChainJoint("shoulder", hinges, BONE_VECTOR)
    elbow = ChainJoint("elbow", (hinge("bend", 0, -1, 0),), BONE_VECTOR)
    wrist = ChainJoint("wrist", (), BONE_VECTOR)
    indices = tuple(range(3, 4 + len(hinges)))
    return Chain("arm", "base", np.zeros(3), (shoulder, elbow, wrist), indices, np.array([0.0, 1, 0]))


def test_arms_of_the_default_robot_already_have_ideal_axes():
    robot = Robot.load()
    for side in ("l", "r"):
        assert robot.arms[side].indices == robot.joints(f"{side}_arm")
        assert idealise(robot.arms[side]) is robot.arms[side]


def test_nearly_aligned_twist_hinge_is_aligned_with_its_bone():
    ideal = idealise(chain(hinge("a", 0, 1, 0), hinge("b", 1, 0, 0), hinge("c", 0.1, 0.1, 1)))
    assert ideal.joints[0].hinges[2].axis == pytest.approx([0, 0, 1])
    assert ideal.joints[0].hinges[2].name == "c"
    assert ideal.indices == (3, 4, 5, 6)


def test_redundant_third_swing_hinge_is_dropped():
    ideal = idealise(chain(hinge("a", 1, 0, 0), hinge("b", 0, 0.1, 1), hinge("c", 0, 1, 0)))
    assert [h.name for h in ideal.joints[0].hinges] == ["a", "c"]
    assert ideal.indices == (3, 5, 6)


def test_two_swing_hinges_of_a_joint_are_kept():
    plain = chain(hinge("a", 0, 1, 0.3), hinge("b", 1, 0, 0))
    assert idealise(plain) is plain
