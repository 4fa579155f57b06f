from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.ik.strand import strand_to
from kinesic.ik.two_hands import Both, reach_both

from ..reference.ik import two_hands as reference

DEFAULT_ROBOT = Robot.load()
ROBOT_SKELETON = DEFAULT_ROBOT.skeleton
REST_ANGLES = ROBOT_SKELETON.rest  # (n,) [rad] rest posture
# index of the wrist's segment, by side
WRIST_SEGMENTS = {side: ROBOT_SKELETON.segment(DEFAULT_ROBOT.arms[side].joints[-1].name) for side in SIDES}
TORSO_JOINTS = list(DEFAULT_ROBOT.joints("torso"))  # hinge indices of the torso


def _hands(angles: Floats) -> dict[Side, Floats]:
    origins = ROBOT_SKELETON.frames(angles).origins
    return {side: origins[WRIST_SEGMENTS[side]] for side in SIDES}


def _check(found: Both, targets: dict[Side, Floats]) -> None:
    assert np.all((ROBOT_SKELETON.lower <= found.angles) & (found.angles <= ROBOT_SKELETON.upper))
    for side, hand in _hands(found.angles).items():
        assert found.residuals[side] == pytest.approx(np.linalg.norm(hand - targets[side]), abs=1e-12)
    assert found.reached == (max(found.residuals.values()) <= 1e-3)
    assert found.torso_travel == pytest.approx(np.abs(found.angles - REST_ANGLES)[TORSO_JOINTS].sum())


def test_low_torso_weight_reaches_two_hand_targets_with_less_torso_motion():
    travel, reached = {1.0: 0.0, 0.15: 0.0}, {1.0: 0, 0.15: 0}
    for weight in travel:
        random = default_rng(51)
        for _ in range(60):
            targets = _hands(random.uniform(ROBOT_SKELETON.lower, ROBOT_SKELETON.upper))
            solution = reach_both(DEFAULT_ROBOT, targets, start=REST_ANGLES, torso_weight=weight)
            _check(solution, targets)
            travel[weight] += solution.torso_travel
            reached[weight] += solution.reached
    assert min(reached.values()) >= 0.97 * 60
    assert travel[0.15] < travel[1.0]


def test_two_hand_ik_does_not_move_the_torso_if_the_arms_reach_the_targets():
    targets = _hands(REST_ANGLES)
    solution = reach_both(DEFAULT_ROBOT, targets, start=REST_ANGLES)
    _check(solution, targets)
    assert solution.reached
    assert solution.torso_travel == 0.0


def test_two_hand_ik_with_torso_weight_zero_does_not_move_the_torso_for_far_targets():
    targets = {"l": np.array([0.6, 0.2, 0.9]), "r": np.array([0.6, -0.2, 0.9])}
    stays = reach_both(DEFAULT_ROBOT, targets, start=REST_ANGLES, torso_weight=0.0)
    helps = reach_both(DEFAULT_ROBOT, targets, start=REST_ANGLES, torso_weight=1.0)
    assert stays.torso_travel == 0.0
    assert helps.torso_travel > 0.1
    assert sum(helps.residuals.values()) < sum(stays.residuals.values())


def test_two_hand_ik_does_not_move_hinges_outside_torso_and_arms():
    start = REST_ANGLES.copy()
    others = [
        k
        for k in range(len(REST_ANGLES))
        if k not in (*TORSO_JOINTS, *DEFAULT_ROBOT.arms["l"].indices, *DEFAULT_ROBOT.arms["r"].indices)
    ]
    start[others] = 0.1
    solution = reach_both(DEFAULT_ROBOT, _hands(ROBOT_SKELETON.lower * 0.5), start=start)
    assert np.array_equal(solution.angles[others], start[others])


@pytest.mark.parametrize(("first", "other"), [("l", "r"), ("r", "l")])
def test_hand_with_priority_reaches_its_target_within_1_mm(first, other):
    random, away = default_rng(52), {"l": 1.0, "r": -1.0}
    for _ in range(8):
        targets = _hands(random.uniform(ROBOT_SKELETON.lower, ROBOT_SKELETON.upper))
        targets[other] = np.array([random.uniform(0.0, 0.5), away[other] * random.uniform(0.8, 1.0), 0.9])
        solution = reach_both(DEFAULT_ROBOT, targets, start=REST_ANGLES, priority=first)
        _check(solution, targets)
        assert solution.residuals[first] < 1e-3
        assert not solution.reached


def test_repeated_two_hand_solves_are_identical():
    targets = _hands(ROBOT_SKELETON.upper * 0.6)
    one, two = (reach_both(DEFAULT_ROBOT, targets, start=REST_ANGLES) for _ in range(2))
    assert one.angles.tobytes() == two.angles.tobytes()


@pytest.mark.parametrize("name", ["upper22", "upper36"])
def test_compiled_two_hand_solutions_equal_the_python_reference(name: str):
    robot, random = Robot.load(name), default_rng(53)
    lower, upper = robot.skeleton.lower, robot.skeleton.upper
    for k in range(6):
        origins = robot.skeleton.frames(random.uniform(lower, upper)).origins
        targets = {side: origins[robot.arm(side).wrist] * (1.3 if k % 4 == 3 else 1.0) for side in SIDES}
        start = lower * 0.4 + upper * 0.3 if k % 2 else robot.skeleton.rest
        weight, first = (0.15, 1.0, 0.0)[k // 4 % 3], (None, "l", "r")[k % 3]
        one, other = (
            solve_both(robot, targets, start=start, torso_weight=weight, priority=first)
            for solve_both in (reach_both, reference.reach_both)
        )
        assert np.abs(one.angles - other.angles).max() < 1e-8
        assert (one.rounds, one.reached) == (other.rounds, other.reached)
        assert one.torso_travel == pytest.approx(other.torso_travel, abs=1e-8)
        assert all(one.residuals[side] == pytest.approx(other.residuals[side], abs=1e-8) for side in SIDES)


def test_invalid_two_hand_ik_arguments_raise_clear_errors():
    good = _hands(REST_ANGLES)
    with pytest.raises(ValueError, match=r"hands are \['l'\]; both are needed"):
        reach_both(DEFAULT_ROBOT, {"l": good["l"]}, start=REST_ANGLES)
    with pytest.raises(ValueError, match=r"target of hand r is .*nan.*finite"):
        reach_both(DEFAULT_ROBOT, {"l": good["l"], "r": np.array([np.nan, 0, 0])}, start=REST_ANGLES)
    with pytest.raises(ValueError, match=r"torso_weight is 2.0; it must be between 0"):
        reach_both(DEFAULT_ROBOT, good, start=REST_ANGLES, torso_weight=2.0)
    with pytest.raises(ValueError, match=r"start has shape \(3,\)"):
        reach_both(DEFAULT_ROBOT, good, start=np.zeros(3))


def test_end_position_and_jacobian_of_a_joint_path_match_the_skeleton():
    random = default_rng(61)
    for name in ("l_wrist", "r_wrist", "skullbase"):
        strand = strand_to(ROBOT_SKELETON, name)
        angles = random.uniform(ROBOT_SKELETON.lower, ROBOT_SKELETON.upper)
        end, columns = strand.end(angles.tolist())
        assert np.allclose(end, ROBOT_SKELETON.frames(angles).origins[ROBOT_SKELETON.segment(name)], atol=1e-12)
        for joint, column in zip(strand.joints, columns, strict=True):
            moved = angles.copy()
            moved[joint] += 1e-6
            assert np.allclose((np.array(strand.end(moved.tolist())[0]) - end) / 1e-6, column, atol=1e-5)


def test_joint_path_to_a_segment_excludes_joints_that_do_not_move_its_origin():
    strand = strand_to(ROBOT_SKELETON, "l_wrist")
    assert set(strand.joints).isdisjoint(ROBOT_SKELETON.joints_of(("l_wrist",)))
    assert len(strand.joints) == 3 + 1 + 3 + 2


def test_joints_with_axis_offset_are_included_in_the_path_and_its_jacobian():
    random = default_rng(62)
    hinges = [replace(hinge, at=sealed(random.uniform(-0.03, 0.03, 3))) for hinge in ROBOT_SKELETON.hinges]
    skeleton = replace(ROBOT_SKELETON, hinges=tuple(hinges))
    strand = strand_to(skeleton, "l_wrist")
    angles = random.uniform(skeleton.lower, skeleton.upper)
    end, columns = strand.end(angles.tolist())
    assert np.allclose(end, skeleton.frames(angles).origins[skeleton.segment("l_wrist")], atol=1e-12)
    assert set(skeleton.joints_of(("l_wrist",))) <= set(strand.joints)
    for joint, column in zip(strand.joints, columns, strict=True):
        moved = angles.copy()
        moved[joint] += 1e-6
        assert np.allclose((np.array(strand.end(moved.tolist())[0]) - end) / 1e-6, column, atol=1e-5)
