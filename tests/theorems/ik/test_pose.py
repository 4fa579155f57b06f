"""What holds for every pose, every pair of hands and every target beyond reach."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.nearest import finish
from kinesic.ik.pose import solve_pose
from kinesic.ik.two_hands import reach_both

from ...examples import examples

ROBOT = Robot.load()
LEFT, RIGHT = ROBOT.arms["l"], ROBOT.arms["r"]
FLIP = np.array([1.0, -1.0, 1.0])

number = st.floats(-1.0, 1.0)
places = st.tuples(number, number, number).map(np.array)
turns = st.tuples(number, number, number).map(lambda v: Rotation.from_rotvec(3.0 * np.array(v)).as_matrix())
shares = st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8).map(np.array)

inner = st.lists(st.floats(0.05, 0.95), min_size=8, max_size=8).map(np.array)  # at stops a few are missed: test_pose


def _posture(share: Floats) -> Floats:
    return LEFT.lower + share * (LEFT.upper - LEFT.lower)


@examples(50, derandomize=True)
@given(share=inner, start=shares)
def test_what_a_posture_inside_the_ranges_holds_is_held(share, start):
    rotations, centres = LEFT.frames(_posture(share))
    found = solve_pose(LEFT, centres[-2], rotations[-1], start=_posture(start))
    assert found.residual < 1e-3
    assert found.turn < 1e-2


@settings(max_examples=15, deadline=None, derandomize=True)
@given(place=places, turn=turns, start=shares)
def test_any_pose_has_an_answer_in_the_ranges_and_the_right_arm_mirrors_the_left(place, turn, start):
    left = solve_pose(LEFT, 0.5 * place, turn, start=_posture(start))
    right = solve_pose(RIGHT, 0.5 * place * FLIP, FLIP[:, None] * turn * FLIP, start=_posture(start))
    at = LEFT.frames(left.angles)
    assert np.all((LEFT.lower <= left.angles) & (left.angles <= LEFT.upper))
    assert abs(np.linalg.norm(at[1][-2] - 0.5 * place) - left.residual) < 1e-9
    assert abs(Rotation.from_matrix(turn @ at[0][-1].T).magnitude() - left.turn) < 1e-6
    assert np.abs(left.angles - right.angles).max() < 1e-9


@settings(max_examples=15, deadline=None, derandomize=True)
@given(left=places, right=places, weight=st.floats(0.0, 1.0))
def test_any_pair_of_targets_has_an_answer_in_the_ranges(left, right, weight):
    rest = ROBOT.skeleton.rest
    found = reach_both(ROBOT, {"l": left, "r": right}, start=rest, torso_weight=weight)
    assert np.all((ROBOT.skeleton.lower <= found.angles) & (found.angles <= ROBOT.skeleton.upper))
    assert np.all(np.isfinite(found.angles))


@examples(100, derandomize=True)
@given(place=places, start=shares, far=st.floats(0.1, 10.0))
def test_finishing_never_loses_ground(place, start, far):
    linkage, posture = linkage_of(LEFT), _posture(start)
    x, y, z = (far * place).tolist()
    found = finish(linkage, (x, y, z), [posture.tolist()])
    assert found.miss <= np.linalg.norm(LEFT.hand(posture) - far * place) * (1 + 1e-12)
    angles = np.array(found.angles)
    assert np.all((LEFT.lower[: len(angles)] <= angles) & (angles <= LEFT.upper[: len(angles)]))
