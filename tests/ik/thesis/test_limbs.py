import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.ik.thesis.boxes import EulerBoxes
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.limbs import Limb, Limbs

DEFAULT_ROBOT = Robot.load("upper22")
# chain of two bones, from the ground up
TRUNK_CHAIN = BallChain.of([(0.0, 0.0, 0.0), (0.0, 0.0, 0.3), (0.0, 0.0, 0.5)])
# chain of two bones, from the end of the trunk
ARM_CHAIN = BallChain.of([(0.0, 0.0, 0.5), (0.0, 0.2, 0.5), (0.2, 0.2, 0.5)])


def test_limb_tree_of_the_robot_is_a_torso_with_two_arms():
    limbs = Limbs.of_robot(DEFAULT_ROBOT)
    assert [(limb.name, limb.on) for limb in limbs.members] == [("torso", None), ("l_arm", "torso"), ("r_arm", "torso")]
    chains = {limb.name: limb.chain for limb in limbs.members}
    for side in ("l", "r"):
        chain, arm = chains[f"{side}_arm"], DEFAULT_ROBOT.arms[side]
        assert chain.lengths[1:] == pytest.approx(arm.lengths[:-1])
        assert chain.points[0] == pytest.approx(chains["torso"].points[-1])
    mirror = np.array([1.0, -1.0, 1.0])
    assert chains["l_arm"].points == pytest.approx(chains["r_arm"].points * mirror)


def test_joint_common_to_several_limbs_is_one_mass():
    limbs = Limbs((Limb("trunk", TRUNK_CHAIN), Limb("left", ARM_CHAIN, "trunk"), Limb("right", ARM_CHAIN, "trunk")))
    assert limbs.indices == {"trunk": [0, 1, 2], "left": [2, 3, 4], "right": [2, 5, 6]}
    assert [limb.name for limb in limbs.hanging_on("trunk")] == ["left", "right"]
    assert limbs.reach == pytest.approx({"trunk": 0.5, "left": 0.9, "right": 0.9})
    assert limbs.size == pytest.approx(0.9)
    assert limbs.root("right").tolist() == [0.0, 0.0, 0.0]


def test_limb_with_a_free_first_joint_keeps_the_limits_of_its_second_joint():
    wide, narrow = [np.pi, np.pi / 2.0, np.pi], [0.5, 0.5, 0.5]
    boxes = EulerBoxes.of(-np.array([wide, narrow]), np.array([wide, narrow]), joints=2)
    limbs = Limbs((Limb("trunk", TRUNK_CHAIN), Limb("arm", BallChain.of(ARM_CHAIN.points, limits=boxes), "trunk")))
    limits = limbs.members[1].chain.limits
    assert limits is not None
    assert limits.upper[1].tolist() == narrow


@pytest.mark.parametrize(
    ("members", "lesson"),
    [
        ((), "no limb"),
        ((Limb("trunk", TRUNK_CHAIN), Limb("trunk", ARM_CHAIN, "trunk")), "two limbs are named trunk"),
        (
            (Limb("arm", ARM_CHAIN, "trunk"), Limb("trunk", TRUNK_CHAIN)),
            "arm hangs on trunk, which is not among the limbs before it",
        ),
        ((Limb("trunk", TRUNK_CHAIN), Limb("arm", TRUNK_CHAIN, "trunk")), "arm begins 0.5 m from the end of trunk"),
        (
            (
                Limb("trunk", TRUNK_CHAIN),
                Limb("arm", BallChain.of(ARM_CHAIN.points, limits=EulerBoxes.of(-0.5, 0.5, joints=2)), "trunk"),
            ),
            "arm limits the joint that it shares",
        ),
    ],
)
def test_invalid_limb_trees_raise_clear_errors(members, lesson):
    with pytest.raises(ValueError, match=lesson):
        Limbs(members)
