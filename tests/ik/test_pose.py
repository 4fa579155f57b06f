import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic.bench.ik.arms import random_arm
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Hinge
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.pose import PoseSolution, solve_pose

from ..reference.ik import pose as reference
from ..reference.ik.pose import _errors
from ..reference.ik.swivel_search import GIRDLE_STEPS, SWIVEL_STEPS

ARM_CHAINS = Robot.load().arms  # chains of both arms, by side
LEFT_ARM = ARM_CHAINS["l"]  # chain of the left arm


def _pose(chain: Chain, angles: Floats) -> tuple[Floats, Floats]:
    rotations, centres = chain.frames(angles)
    return centres[-2], rotations[-1]


def _check(chain: Chain, found: PoseSolution, position: Floats, rotation: Floats) -> None:
    """Check reported errors with independent forward kinematics and rotation formula."""
    at, turned = _pose(chain, found.angles)
    assert np.all((chain.lower <= found.angles) & (found.angles <= chain.upper))
    assert found.residual == pytest.approx(np.linalg.norm(at - position), abs=1e-9)
    assert found.turn == pytest.approx(Rotation.from_matrix(rotation @ turned.T).magnitude(), abs=1e-6)


@pytest.mark.parametrize("side", ["l", "r"])
def test_ik_reaches_hand_poses_of_random_postures(side):
    chain, random = ARM_CHAINS[side], default_rng(21)
    for _ in range(100):
        position, rotation = _pose(chain, random.uniform(chain.lower, chain.upper))
        solution = solve_pose(chain, position, rotation, start=chain.rest)
        _check(chain, solution, position, rotation)
        assert solution.reached


def test_ik_reaches_hand_poses_from_starts_at_the_joint_limits():
    random = default_rng(22)
    for start in (LEFT_ARM.lower, LEFT_ARM.upper, np.zeros(8)):
        for _ in range(20):
            position, rotation = _pose(LEFT_ARM, random.uniform(LEFT_ARM.lower, LEFT_ARM.upper))
            assert solve_pose(LEFT_ARM, position, rotation, start=start).reached


def test_ik_reaches_hand_poses_with_joints_at_their_limits():
    random = default_rng(25)
    for _ in range(60):
        share = random.uniform(0.0, 1.0, (2, len(LEFT_ARM.lower)))
        share = np.where(random.uniform(0.0, 1.0, share.shape) < 0.6, np.round(share), share)
        angles, start = LEFT_ARM.lower + share * (LEFT_ARM.upper - LEFT_ARM.lower)
        assert solve_pose(LEFT_ARM, *_pose(LEFT_ARM, angles), start=start).residual < 1e-3


@pytest.mark.parametrize(
    "chain",
    [
        *ARM_CHAINS.values(),
        *(random_arm(default_rng(seed)) for seed in (70, 71)),
        *(pytest.param(random_arm(default_rng(seed)), marks=pytest.mark.soak) for seed in (72, 73, 74)),
    ],
)
def test_compiled_hand_pose_search_equals_the_python_reference(chain: Chain):
    """Expect angles within 1e-12 rad unless numerical descent refined the solution."""
    random = default_rng(42)
    for k in range(4, 8):
        start, angles = random.uniform(chain.lower, chain.upper, (2, len(chain.rest)))
        position, rotation = _pose(chain, angles)
        asked = position * (1.5 if k == 7 else 1.0)
        one, two = (hold(chain, asked, rotation, start=start) for hold in (reference.solve_pose, solve_pose))
        assert one.cells == two.cells
        assert (one.reached, one.residual) == pytest.approx((two.reached, two.residual), abs=1e-6)
        assert np.abs(one.angles - two.angles).max() < (1e-12 if one.rounds == 0 else 1e-5)


def test_ik_reaches_over_99_percent_of_hand_poses_of_random_arms():
    random, held = default_rng(43), []
    for _ in range(24):
        chain = random_arm(random)
        for _ in range(25):
            position, rotation = _pose(chain, random.uniform(chain.lower, chain.upper))
            held.append(solve_pose(chain, position, rotation, start=chain.rest).reached)
    assert np.mean(held) >= 0.995


def test_ik_keeps_a_posture_that_already_has_the_hand_pose():
    random = default_rng(23)
    for _ in range(30):
        angles = random.uniform(0.9 * LEFT_ARM.lower, 0.9 * LEFT_ARM.upper)
        solution = solve_pose(LEFT_ARM, *_pose(LEFT_ARM, angles), start=angles)
        assert solution.cells == 1
        assert np.abs(solution.angles - angles).max() < 1e-6


def test_ik_reaches_hand_poses_without_collar_bone_or_with_swapped_wrist_axes():
    random, bare = default_rng(24), replace(LEFT_ARM, joints=LEFT_ARM.joints[1:], indices=LEFT_ARM.indices[1:])
    hand = bare.joints[-1]
    swapped = replace(bare, joints=(*bare.joints[:-1], replace(hand, hinges=hand.hinges[::-1])))
    for chain in (bare, swapped):
        for _ in range(40):
            position, rotation = _pose(chain, random.uniform(chain.lower, chain.upper))
            assert solve_pose(chain, position, rotation, start=chain.rest).reached


def test_arm_without_forearm_twist_reaches_a_feasible_hand_pose():
    elbow = LEFT_ARM.joints[2]
    stiff = replace(
        LEFT_ARM, joints=(*LEFT_ARM.joints[:2], replace(elbow, hinges=elbow.hinges[:1]), LEFT_ARM.joints[3])
    )
    position, rotation = _pose(stiff, np.array([0.1, 0.6, 0.4, -0.3, 1.2, 0.1, -0.1]))
    solution = solve_pose(stiff, position, rotation, start=stiff.rest)
    _check(stiff, solution, position, rotation)
    assert solution.reached


def test_unreachable_hand_pose_returns_angles_in_range_and_reports_its_errors():
    position, rotation = np.array([2.0, 0.5, 0.0]), Rotation.from_rotvec([0.3, 2.0, -1.0]).as_matrix()
    solution = solve_pose(LEFT_ARM, position, rotation, start=LEFT_ARM.rest)
    _check(LEFT_ARM, solution, position, rotation)
    assert not solution.reached


def test_hand_orientation_error_of_half_a_turn_is_measured():
    position, rotation = _pose(LEFT_ARM, LEFT_ARM.rest)
    for axis in np.eye(3):
        opposite = rotation @ Rotation.from_rotvec(np.pi * axis).as_matrix()
        _check(LEFT_ARM, solve_pose(LEFT_ARM, position, opposite, start=LEFT_ARM.rest), position, opposite)


def test_invalid_hand_pose_arguments_raise_clear_errors():
    good, straight = np.array([0.3, 0.2, 0.0]), np.eye(3)
    with pytest.raises(ValueError, match=r"position is .*nan.*finite"):
        solve_pose(LEFT_ARM, np.array([np.nan, 0, 0]), straight, start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"rotation has shape \(3,\).*\(3, 3\)"):
        solve_pose(LEFT_ARM, good, np.zeros(3), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"rotation is .*right-handed"):
        solve_pose(LEFT_ARM, good, np.diag([1.0, 1.0, -1.0]), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"start has shape \(7,\).*\(8,\)"):
        solve_pose(LEFT_ARM, good, straight, start=np.zeros(7))


# left arm without collar bone, so that the shoulder is fixed
BARE_ARM = replace(LEFT_ARM, joints=LEFT_ARM.joints[1:], indices=LEFT_ARM.indices[1:])
FULL_TURN = {"lower": -math.pi, "upper": math.pi}  # [rad] range of an unlimited hinge


def with_hand(chain: Chain, *hinges: Hinge) -> Chain:
    """Return the arm with other hinges behind the elbow, forearm twist first."""
    return replace(chain, joints=(*chain.joints[:-1], replace(chain.joints[-1], hinges=hinges)))


def test_ik_chooses_the_nearer_of_two_solutions_for_a_hand_pose():
    """Use a wrist without limits, which has two solutions for each orientation."""
    bend, tilt = (replace(hinge, **FULL_TURN) for hinge in BARE_ARM.joints[-1].hinges)
    elbow, twist = BARE_ARM.joints[-2].hinges
    loose = replace(BARE_ARM.joints[-2], hinges=(elbow, replace(twist, **FULL_TURN)))
    chain = with_hand(replace(BARE_ARM, joints=(*BARE_ARM.joints[:-2], loose, BARE_ARM.joints[-1])), bend, tilt)
    first = np.array([0.3, 0.5, 0.2, 0.9, 0.4, 0.6, -0.5])
    other = np.array([*first[:4], first[4] - math.pi, math.pi - first[5], first[6] - math.pi])
    position, rotation = _pose(chain, first)
    assert solve_pose(chain, position, rotation, start=first).angles == pytest.approx(first, abs=1e-6)
    flipped = solve_pose(chain, position, rotation, start=np.arctan2(np.sin(other), np.cos(other))).angles
    assert np.abs(flipped[4:] - first[4:]).max() > 1.0
    assert flipped[:4] == pytest.approx(first[:4], abs=1e-6)


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 1, 0), (0, 1, 1), (0, 1, -1), (1, 0, 1), (1, 1, 0), (1, 1, 1)])
def test_ik_reaches_hand_poses_for_seven_directions_of_the_last_wrist_axis(axis: tuple[int, int, int]):
    """Use axes along, or halfway between, coordinate axes."""
    bend, tilt = BARE_ARM.joints[-1].hinges
    chain = with_hand(BARE_ARM, bend, replace(tilt, axis=np.array(axis) / np.linalg.norm(axis), **FULL_TURN))
    posture = np.array([0.3, 0.5, 0.2, 0.9, 0.4, 0.3, 0.7])
    for turn in (-1.0, 0.7, 2.5):
        posture[6] = turn
        near = posture - 0.05
        solution = solve_pose(chain, *_pose(chain, posture), start=near)
        assert solution.reached
        assert solution.cells == 1


@pytest.mark.parametrize("twist", [-0.7, 0.4])
def test_first_of_two_parallel_wrist_axes_keeps_its_angle(twist: float):
    """Use a straight hand, for which both twist axes are parallel."""
    bend, tilt = BARE_ARM.joints[-1].hinges
    along = replace(tilt, axis=BARE_ARM.joints[-2].hinges[-1].axis, lower=-2.0, upper=2.0)
    chain = with_hand(BARE_ARM, bend, along)
    posture = np.array([0.3, 0.5, 0.2, 0.9, 0.1, 0.0, 0.8])
    start = np.array([*posture[:4], twist, 0.0, 0.0])
    solution = solve_pose(chain, *_pose(chain, posture), start=start)
    assert solution.angles == pytest.approx([*posture[:4], twist, 0.0, 0.9 - twist], abs=1e-6)


def test_hand_pose_counts_as_reached_within_0_1_mm():
    straight = np.array([0.3, 0.5, 0.0, 0.0, 0.2, 0.1, 0.0])
    position, rotation = _pose(BARE_ARM, straight)
    outward = (position - BARE_ARM.origin_in_base) / np.linalg.norm(position - BARE_ARM.origin_in_base)
    for beyond, reached in ((0.5e-4, True), (1.5e-4, False)):
        solution = solve_pose(BARE_ARM, position + beyond * outward, rotation, start=straight)
        _check(BARE_ARM, solution, position + beyond * outward, rotation)
        assert solution.residual == pytest.approx(beyond, rel=0.3)
        assert solution.turn < 1e-4
        assert solution.reached == reached


def test_hand_pose_counts_as_reached_within_one_milliradian():
    """Use fixed joints, so that the error is the requested rotation."""
    posture = np.array([0.3, 0.5, 0.2, 0.9, 0.4, 0.3, -0.2])
    ends = iter(posture.tolist())
    joints = tuple(
        replace(joint, hinges=tuple(replace(hinge, lower=(end := next(ends)), upper=end) for hinge in joint.hinges))
        for joint in BARE_ARM.joints
    )
    rigid = replace(BARE_ARM, joints=joints)
    position, rotation = _pose(rigid, posture)
    for beyond, reached in ((0.5e-3, True), (1.6e-3, False)):
        asked = rotation @ Rotation.from_rotvec([0.0, beyond, 0.0]).as_matrix()
        solution = solve_pose(rigid, position, asked, start=posture)
        assert solution.turn == pytest.approx(beyond)
        assert solution.residual < 1e-9
        assert solution.reached == reached


def test_hand_pose_search_counts_the_tried_postures():
    random = default_rng(26)
    position, rotation = _pose(LEFT_ARM, random.uniform(0.5 * LEFT_ARM.lower, 0.5 * LEFT_ARM.upper))
    near, far = (solve_pose(LEFT_ARM, factor * position, rotation, start=LEFT_ARM.rest) for factor in (1.0, 9.0))
    assert near.reached
    assert near.rounds == 0
    assert 1 <= near.cells < far.cells == SWIVEL_STEPS * (1 + GIRDLE_STEPS)
    assert far.rounds > 0


def test_ik_start_angle_outside_its_range_is_clipped_to_the_limit():
    position, rotation = _pose(LEFT_ARM, LEFT_ARM.rest)
    for stop, away in ((LEFT_ARM.upper, 1.0), (LEFT_ARM.lower, -1.0)):
        inside, outside = (solve_pose(LEFT_ARM, position, rotation, start=start) for start in (stop, stop + away))
        assert (inside.angles == outside.angles).all()


@pytest.mark.parametrize(
    "convert", [np.ndarray.tolist, np.asfortranarray, np.float32], ids=["list", "Fortran", "float32"]
)
def test_hand_pose_is_solved_for_lists_fortran_order_and_float32(convert):
    position, rotation = _pose(LEFT_ARM, LEFT_ARM.rest + 0.3 * (LEFT_ARM.upper - LEFT_ARM.rest))
    expected = solve_pose(LEFT_ARM, position, rotation, start=LEFT_ARM.rest)
    result = solve_pose(LEFT_ARM, convert(position), convert(rotation), start=LEFT_ARM.rest)
    assert expected.reached
    np.testing.assert_allclose(result.angles, expected.angles, atol=1e-5)


def test_hand_pose_accepts_a_rotation_matrix_with_rounding_errors():
    position, rotation = _pose(LEFT_ARM, LEFT_ARM.rest)
    assert solve_pose(LEFT_ARM, position, rotation * (1.0 + 4e-7), start=LEFT_ARM.rest).reached
    with pytest.raises(ValueError, match="perpendicular unit vectors"):
        solve_pose(LEFT_ARM, position, rotation * (1.0 + 6e-7), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match="perpendicular unit vectors"):
        solve_pose(LEFT_ARM, position, rotation * (1.0 - 6e-7), start=LEFT_ARM.rest)


def test_hand_pose_jacobian_is_the_derivative_of_the_pose_errors():
    linkage, random, step = linkage_of(LEFT_ARM), default_rng(28), 1e-6
    for _ in range(10):
        angles = random.uniform(LEFT_ARM.lower, LEFT_ARM.upper)
        position, rotation = _pose(LEFT_ARM, angles)
        errors = _errors(linkage, tuple(position.tolist()), tuple(rotation.ravel().tolist()))
        error, jacobian = errors(angles)
        assert error == pytest.approx(np.zeros(6), abs=1e-9)
        for k in range(8):
            aside = step * np.eye(8)[k]
            slope = (errors(angles + aside)[0] - errors(angles - aside)[0]) / (2 * step)
            assert jacobian[:, k] == pytest.approx(-slope, abs=1e-6)
