"""Properties of the arm solver over random targets."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.scalar3 import distance
from kinesic.ik.solve import solve
from kinesic.ik.torso import MAX_TURN, lean_torso

from ...examples import examples
from ...reference.ik.masses import settle_masses

DEFAULT_ROBOT = Robot.load()
LEFT_ARM, RIGHT_ARM = DEFAULT_ROBOT.arms["l"], DEFAULT_ROBOT.arms["r"]
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])

number = st.floats(-1.0, 1.0)
positions = st.tuples(number, number, number).map(np.array)
directions = st.none() | st.tuples(number, number, number).map(np.array).filter(lambda v: np.linalg.norm(v) > 0.01)
shares = st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8).map(np.array)
reaches = st.builds(Reach, positions, directions, directions, st.none() | st.floats(-4.0, 4.0))


def _posture(share: Floats) -> Floats:
    return LEFT_ARM.lower + share * (LEFT_ARM.upper - LEFT_ARM.lower)


def _mirrored(reach: Reach) -> Reach:
    def flipped(vector: Floats | None) -> Floats | None:
        return None if vector is None else vector * MIRROR_SIGNS

    return Reach(reach.position * MIRROR_SIGNS, flipped(reach.pointing), flipped(reach.palm), reach.swivel)


@examples(150, derandomize=True)
@given(reach=reaches, start=shares)
def test_arm_solution_is_within_joint_ranges_and_its_residual_is_correct(reach: Reach, start: Floats) -> None:
    solution = solve(LEFT_ARM, reach, start=_posture(start))
    assert np.all(LEFT_ARM.lower <= solution.angles)
    assert np.all(solution.angles <= LEFT_ARM.upper)
    assert abs(solution.residual - np.linalg.norm(LEFT_ARM.hand(solution.angles) - reach.position)) < 1e-12
    assert (solution.pointing_error is None) == (reach.pointing is None)
    assert (solution.palm_error is None) == (reach.palm is None)


@examples(80, derandomize=True)
@given(reach=reaches, start=shares)
def test_arm_solutions_are_mirror_images_and_deterministic(reach: Reach, start: Floats) -> None:
    left = solve(LEFT_ARM, reach, start=_posture(start))
    right = solve(RIGHT_ARM, _mirrored(reach), start=_posture(start))
    assert np.abs(left.angles - right.angles).max() < 1e-9
    assert solve(LEFT_ARM, reach, start=_posture(start)).angles.tobytes() == left.angles.tobytes()


@examples(150, derandomize=True)
@given(share=shares, start=shares)
def test_arm_solver_reaches_hand_positions_of_postures_in_range(share: Floats, start: Floats) -> None:
    solution = solve(LEFT_ARM, Reach(LEFT_ARM.hand(_posture(share))), start=_posture(start))
    assert solution.residual < 2e-3


@examples(80, derandomize=True)
@given(start=shares, target=positions)
def test_reference_mass_chain_keeps_its_base_and_stays_within_the_arm_length(start: Floats, target: Floats) -> None:
    linkage = linkage_of(LEFT_ARM)
    points = linkage.walk(_posture(start).tolist(), 3)[1]
    lengths = [link.length for link in linkage.links[:3]]
    settled = settle_masses(points, lengths, tuple(target.tolist()))
    assert settled.points[0] == points[0]
    assert distance(settled.points[0], settled.points[-1]) <= sum(lengths) * (1 + 1e-12)
    assert np.all(np.isfinite(settled.points))


@examples(60, derandomize=True)
@given(left=positions, right=positions)
def test_torso_lean_stays_within_its_rotation_limit(left: Floats, right: Floats) -> None:
    turn = np.array(lean_torso(DEFAULT_ROBOT, {"l": left, "r": right}))
    joints = list(DEFAULT_ROBOT.joints("torso"))
    assert np.all(np.abs(turn) <= MAX_TURN)
    assert np.all((DEFAULT_ROBOT.skeleton.lower[joints] <= turn) & (turn <= DEFAULT_ROBOT.skeleton.upper[joints]))
