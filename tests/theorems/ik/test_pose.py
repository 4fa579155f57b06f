"""Properties of pose IK: single poses, pairs of hands and unreachable targets."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.pose import solve_pose
from kinesic.ik.two_hands import reach_both

from ...examples import examples
from ...reference.ik.nearest import finish

DEFAULT_ROBOT = Robot.load()
LEFT_ARM, RIGHT_ARM = DEFAULT_ROBOT.arms["l"], DEFAULT_ROBOT.arms["r"]
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])

number = st.floats(-1.0, 1.0)
places = st.tuples(number, number, number).map(np.array)
turns = st.tuples(number, number, number).map(lambda v: Rotation.from_rotvec(3.0 * np.array(v)).as_matrix())
shares = st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8).map(np.array)

# Near joint limits a few poses are missed (see test_pose)
inner = st.lists(st.floats(0.05, 0.95), min_size=8, max_size=8).map(np.array)


def _posture(share: Floats) -> Floats:
    return LEFT_ARM.lower + share * (LEFT_ARM.upper - LEFT_ARM.lower)


@examples(50, derandomize=True)
@given(share=inner, start=shares)
def test_hand_poses_of_postures_inside_the_joint_ranges_are_reached(share, start):
    rotations, centres = LEFT_ARM.frames(_posture(share))
    solution = solve_pose(LEFT_ARM, centres[-2], rotations[-1], start=_posture(start))
    assert solution.residual < 1e-3
    assert solution.turn < 1e-2


@settings(max_examples=15, deadline=None, derandomize=True)
@given(place=places, turn=turns, start=shares)
def test_pose_ik_of_any_target_keeps_joint_ranges_and_mirrors_for_the_other_arm(place, turn, start):
    left = solve_pose(LEFT_ARM, 0.5 * place, turn, start=_posture(start))
    right = solve_pose(
        RIGHT_ARM, 0.5 * place * MIRROR_SIGNS, MIRROR_SIGNS[:, None] * turn * MIRROR_SIGNS, start=_posture(start)
    )
    at = LEFT_ARM.frames(left.angles)
    assert np.all((LEFT_ARM.lower <= left.angles) & (left.angles <= LEFT_ARM.upper))
    assert abs(np.linalg.norm(at[1][-2] - 0.5 * place) - left.residual) < 1e-9
    assert abs(Rotation.from_matrix(turn @ at[0][-1].T).magnitude() - left.turn) < 1e-6
    assert np.abs(left.angles - right.angles).max() < 1e-9


@settings(max_examples=15, deadline=None, derandomize=True)
@given(left=places, right=places, weight=st.floats(0.0, 1.0))
def test_two_hand_ik_of_any_targets_keeps_joint_ranges(left, right, weight):
    rest = DEFAULT_ROBOT.skeleton.rest
    solution = reach_both(DEFAULT_ROBOT, {"l": left, "r": right}, start=rest, torso_weight=weight)
    assert np.all((DEFAULT_ROBOT.skeleton.lower <= solution.angles) & (solution.angles <= DEFAULT_ROBOT.skeleton.upper))
    assert np.all(np.isfinite(solution.angles))


@examples(100, derandomize=True)
@given(place=places, start=shares, far=st.floats(0.1, 10.0))
def test_ik_refinement_never_increases_the_residual(place, start, far):
    linkage, posture = linkage_of(LEFT_ARM), _posture(start)
    x, y, z = (far * place).tolist()
    result = finish(linkage, (x, y, z), [posture.tolist()])
    assert result.miss <= np.linalg.norm(LEFT_ARM.hand(posture) - far * place) * (1 + 1e-12)
    angles = np.array(result.angles)
    assert np.all((LEFT_ARM.lower[: len(angles)] <= angles) & (angles <= LEFT_ARM.upper[: len(angles)]))
