import numpy as np
import pytest
from numpy.random import Generator, default_rng
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.ik.thesis.boxes import EulerBoxes
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.limbs import Limb, Limbs
from kinesic.ik.thesis.rotations import Carrier, stance_of
from kinesic.ik.thesis.several import RelaxedTree, solve_several, standing_limbs, turn_joints
from kinesic.ik.thesis.task import Effort

ROBOT_LIMBS = Limbs.of_robot(Robot.load("upper22"))  # torso and arms of the robot
LIMB_CHAINS = {limb.name: limb.chain for limb in ROBOT_LIMBS.members}  # chain of each limb, by name
# [m] hand targets that are too far apart to be reached together
DISTANT_TARGETS = {"l_arm": np.array([0.45, 0.45, 1.15]), "r_arm": np.array([-0.45, -0.45, 0.95])}
REST_STANCES = standing_limbs(ROBOT_LIMBS)  # rest posture of each limb


def _pair(random: Generator) -> dict[str, Floats]:
    """Return both hand positions in a random posture of torso and arms."""
    torso = LIMB_CHAINS["torso"]
    bend = Rotation.from_rotvec(random.uniform(-0.4, 0.4, (len(torso.lengths), 3))).as_matrix()
    end = stance_of(torso, bend, Carrier.at_rest(torso)).end
    chest = Rotation.from_rotvec(random.uniform(-0.4, 0.4, 3)).as_matrix()
    hands = {}
    for name in ("l_arm", "r_arm"):
        chain = LIMB_CHAINS[name]
        turns = Rotation.from_rotvec(random.uniform(-1.0, 1.0, (len(chain.lengths), 3))).as_matrix()
        turns[0] = chain.frames[0].T @ chest @ chain.frames[0]
        hands[name] = stance_of(chain, turns, end).points[-1]
    return hands


@pytest.mark.parametrize("priority", [(), ("l_arm",), ("r_arm", "l_arm")])
def test_both_hands_reach_over_90_percent_of_compatible_target_pairs(priority):
    random, both = default_rng(1), []
    for _ in range(16):
        targets = _pair(random)
        reached = solve_several(ROBOT_LIMBS, targets, priority=priority)
        both.append(max(reached.residuals.values()) < 1e-3)
        for name, stance in reached.stances.items():
            assert np.linalg.norm(np.diff(stance.points, axis=0), axis=1) == pytest.approx(LIMB_CHAINS[name].lengths)
        left, right = (reached.stances[name].points for name in ("l_arm", "r_arm"))
        assert left[0] == pytest.approx(reached.stances["torso"].points[-1])
        shoulders = np.linalg.norm(LIMB_CHAINS["l_arm"].points[1] - LIMB_CHAINS["r_arm"].points[1])
        assert np.linalg.norm(left[1] - right[1]) == pytest.approx(shoulders)
        assert all(
            residual == pytest.approx(np.linalg.norm(reached.stances[name].points[-1] - targets[name]))
            for name, residual in reached.residuals.items()
        )
    assert np.mean(both) >= 0.93


def test_limb_priority_decides_between_conflicting_targets():
    alone = {
        name: solve_several(ROBOT_LIMBS, {name: target}).residuals[name] for name, target in DISTANT_TARGETS.items()
    }
    assert max(alone.values()) < 1e-3
    for first, second in (("l_arm", "r_arm"), ("r_arm", "l_arm")):
        reached = solve_several(ROBOT_LIMBS, DISTANT_TARGETS, priority=(first, second)).residuals
        assert reached[first] < 1e-3
        assert reached[second] > 0.05


def test_larger_weight_of_a_limb_reduces_its_target_error():
    loss = {
        weight: solve_several(
            ROBOT_LIMBS, DISTANT_TARGETS, weights={"l_arm": weight}, effort=Effort(rounds=5)
        ).residuals
        for weight in (0.2, 1.0, 5.0)
    }
    assert loss[0.2]["l_arm"] > loss[1.0]["l_arm"] > loss[5.0]["l_arm"]
    assert loss[0.2]["r_arm"] < loss[1.0]["r_arm"] < loss[5.0]["r_arm"]


def test_limb_ik_accepts_a_target_for_the_torso_and_none_for_an_arm():
    torso = LIMB_CHAINS["torso"].points[-1] + np.array([0.1, 0.0, -0.0181])
    reached = solve_several(ROBOT_LIMBS, {"torso": torso, "r_arm": np.array([0.3, -0.2, 0.8])})
    assert set(reached.residuals) == {"torso", "r_arm"}
    assert max(reached.residuals.values()) < 1e-3


def test_limb_of_one_bone_rotates_like_the_other_limbs_at_their_common_joint():
    top = LIMB_CHAINS["torso"].points[-1]
    head = Limb("head", BallChain.of([top, top + np.array([0.0, 0.0, 0.2])]), "torso")
    reached = solve_several(Limbs((*ROBOT_LIMBS.members, head)), {"l_arm": np.array([0.35, 0.1, 0.9])})
    assert reached.residuals["l_arm"] < 1e-3
    turns = [
        s.frames[0] @ c.frames[0].T
        for s, c in ((reached.stances["head"], head.chain), (reached.stances["l_arm"], LIMB_CHAINS["l_arm"]))
    ]
    assert turns[0] == pytest.approx(turns[1])


def test_solution_of_several_limbs_is_independent_of_length_scale():
    targets = _pair(default_rng(3))
    small = solve_several(ROBOT_LIMBS, targets)
    scaled = Limbs(
        tuple(Limb(limb.name, BallChain.of(1e3 * limb.chain.points), limb.on) for limb in ROBOT_LIMBS.members)
    )
    big = solve_several(scaled, {name: 1e3 * target for name, target in targets.items()})
    assert big.iterations == small.iterations
    for name, stance in small.stances.items():
        assert big.stances[name].points / 1e3 == pytest.approx(stance.points, abs=1e-9)


def test_solution_of_several_limbs_keeps_joint_limits_in_every_limb():
    wide, narrow = [np.pi, np.pi / 2.0, np.pi], [0.8, 0.8, 0.8]
    arm = np.array([wide, narrow, narrow, narrow])
    boxes = {
        "torso": EulerBoxes.of(-0.1, 0.1, joints=1),
        "l_arm": EulerBoxes.of(-arm, arm, joints=4),
        "r_arm": EulerBoxes.of(-arm, arm, joints=4),
    }
    limbs = Limbs(
        tuple(Limb(x.name, BallChain.of(x.chain.points, limits=boxes[x.name]), x.on) for x in ROBOT_LIMBS.members)
    )
    reached = solve_several(limbs, _pair(default_rng(4)), effort=Effort(rounds=5))
    for name, box in boxes.items():
        assert box.excess(reached.stances[name].rotations) < 1e-9


@pytest.mark.parametrize(
    ("targets", "given", "lesson"),
    [
        ({}, {}, "no target is given; at least one of torso, l_arm, r_arm"),
        ({"tail": np.zeros(3)}, {}, "there is no limb tail; the limbs are torso, l_arm, r_arm"),
        ({"l_arm": np.array([0.0, np.nan, 0.0])}, {}, "target of l_arm is .* three finite numbers"),
        ({"l_arm": np.zeros(3)}, {"weights": {"l_arm": 0.0}}, "weight of l_arm is 0.0; weights are above zero"),
        ({"l_arm": np.zeros(3)}, {"priority": ("head",)}, "there is no limb head"),
    ],
)
def test_invalid_limb_ik_arguments_raise_clear_errors(targets, given, lesson):
    with pytest.raises(ValueError, match=lesson):
        solve_several(ROBOT_LIMBS, targets, **given)


def _yaw(angle: float):
    return Rotation.from_euler("z", angle).as_matrix()


def _postured(left: float, right: float, pulls, priority=()):
    """Turn joints towards arm masses that are rotated by the given yaw angles."""
    centre = REST_STANCES["torso"].points[-1]
    points = {name: stance.points for name, stance in REST_STANCES.items()}
    points["l_arm"] = centre + (points["l_arm"] - centre) @ _yaw(left).T
    points["r_arm"] = centre + (points["r_arm"] - centre) @ _yaw(right).T
    return turn_joints(
        ROBOT_LIMBS, REST_STANCES, RelaxedTree(points, {}, pulls, priority), method="position", effort=Effort()
    )


def _turn(stances, name: str) -> float:
    """Return the yaw of a limb's first bone relative to rest [rad]."""
    turn = stances[name].frames[0] @ REST_STANCES[name].frames[0].T
    return float(Rotation.from_matrix(turn).as_rotvec()[2])


def test_limb_tree_at_rest_has_the_rest_positions_of_its_chains():
    for limb in ROBOT_LIMBS.members:
        assert REST_STANCES[limb.name].points == pytest.approx(limb.chain.points)


def test_limbs_at_a_common_joint_get_the_same_rotation():
    stances = _postured(0.3, 0.3, {"l_arm": 1.0, "r_arm": 1.0})
    assert _turn(stances, "l_arm") == pytest.approx(_turn(stances, "r_arm"))
    assert 0.05 < _turn(stances, "l_arm") <= 0.31


def test_differently_weighted_arms_keep_the_distance_between_their_shoulders():
    stances = _postured(0.3, -0.1, {"l_arm": 1.0, "r_arm": 3.0})
    span = [np.linalg.norm(s["l_arm"].points[1] - s["r_arm"].points[1]) for s in (REST_STANCES, stances)]
    assert span[0] == pytest.approx(span[1])


@pytest.mark.parametrize(("weight", "sign"), [(9.0, 1.0), (1.0 / 9.0, -1.0)])
def test_common_joint_of_two_limbs_rotates_towards_the_limb_with_more_weight(weight: float, sign: float):
    stances = _postured(0.3, -0.3, {"l_arm": weight, "r_arm": 1.0})
    assert sign * _turn(stances, "l_arm") > 0.05


def test_common_joint_of_two_limbs_does_not_rotate_for_opposite_targets_of_equal_weight():
    assert _turn(_postured(0.3, -0.3, {"l_arm": 1.0, "r_arm": 1.0}), "l_arm") == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("first", "sign"), [("l_arm", 1.0), ("r_arm", -1.0)])
def test_common_joint_of_two_limbs_follows_only_the_limb_with_priority(first: str, sign: float):
    pulls = {"l_arm": 1.0, "r_arm": 1.0}
    stances = _postured(0.3, -0.3, pulls, priority=(first,))
    alone = _postured(sign * 0.3, sign * 0.3, pulls, priority=(first,))
    assert _turn(stances, first) == pytest.approx(_turn(alone, first))
    assert sign * _turn(stances, first) > 0.05
