import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinesic.body.robot import Robot
from kinesic.ik.thesis.limbs import Limbs
from kinesic.ik.thesis.shared import Wishes, standing_limbs, turn_joints
from kinesic.ik.thesis.task import Effort

LIMBS = Limbs.of_robot(Robot.load("upper22"))
REST = standing_limbs(LIMBS)


def _yaw(angle: float):
    return Rotation.from_euler("z", angle).as_matrix()


def _postured(left: float, right: float, pulls, priority=()):
    """Both arms as the masses would have them when each is turned about the sub-base joint alone."""
    centre = REST["torso"].points[-1]
    points = {name: stance.points for name, stance in REST.items()}
    points["l_arm"] = centre + (points["l_arm"] - centre) @ _yaw(left).T
    points["r_arm"] = centre + (points["r_arm"] - centre) @ _yaw(right).T
    return turn_joints(LIMBS, REST, Wishes(points, {}, pulls, priority), method="position", effort=Effort())


def _turn(stances, name: str) -> float:
    """How far the first bone of a limb is turned about the vertical [rad]."""
    turn = stances[name].frames[0] @ REST[name].frames[0].T
    return float(Rotation.from_matrix(turn).as_rotvec()[2])


def test_at_rest_every_limb_stands_where_its_chain_rests():
    for limb in LIMBS.members:
        assert REST[limb.name].points == pytest.approx(limb.chain.points)


def test_limbs_that_agree_turn_their_joint():
    stances = _postured(0.3, 0.3, {"l_arm": 1.0, "r_arm": 1.0})
    assert _turn(stances, "l_arm") == pytest.approx(_turn(stances, "r_arm"))
    assert 0.05 < _turn(stances, "l_arm") <= 0.31


def test_a_shared_joint_has_one_rotation():
    stances = _postured(0.3, -0.1, {"l_arm": 1.0, "r_arm": 3.0})
    span = [np.linalg.norm(s["l_arm"].points[1] - s["r_arm"].points[1]) for s in (REST, stances)]
    assert span[0] == pytest.approx(span[1])


@pytest.mark.parametrize(("weight", "sign"), [(9.0, 1.0), (1.0 / 9.0, -1.0)])
def test_by_weights_the_heavier_limb_turns_the_joint_its_way(weight: float, sign: float):
    stances = _postured(0.3, -0.3, {"l_arm": weight, "r_arm": 1.0})
    assert sign * _turn(stances, "l_arm") > 0.05


def test_equal_weights_hold_each_other():
    assert _turn(_postured(0.3, -0.3, {"l_arm": 1.0, "r_arm": 1.0}), "l_arm") == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("first", "sign"), [("l_arm", 1.0), ("r_arm", -1.0)])
def test_by_priority_one_limb_decides_alone(first: str, sign: float):
    pulls = {"l_arm": 1.0, "r_arm": 1.0}
    stances = _postured(0.3, -0.3, pulls, priority=(first,))
    alone = _postured(sign * 0.3, sign * 0.3, pulls, priority=(first,))
    assert _turn(stances, first) == pytest.approx(_turn(alone, first))
    assert sign * _turn(stances, first) > 0.05
