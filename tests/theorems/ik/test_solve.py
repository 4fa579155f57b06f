"""What holds for every reach."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.masses import settle_masses
from kinesic.ik.scalar3 import distance
from kinesic.ik.solve import solve
from kinesic.ik.torso import LARGEST_TURN, lean_torso

from ...examples import examples

ROBOT = Robot.load()
LEFT, RIGHT = ROBOT.arms["l"], ROBOT.arms["r"]
FLIP = np.array([1.0, -1.0, 1.0])

number = st.floats(-1.0, 1.0)
positions = st.tuples(number, number, number).map(np.array)
directions = st.none() | st.tuples(number, number, number).map(np.array).filter(lambda v: np.linalg.norm(v) > 0.01)
shares = st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8).map(np.array)
reaches = st.builds(Reach, positions, directions, directions, st.none() | st.floats(-4.0, 4.0))


def _posture(share: Floats) -> Floats:
    return LEFT.lower + share * (LEFT.upper - LEFT.lower)


def _mirrored(reach: Reach) -> Reach:
    def flipped(vector: Floats | None) -> Floats | None:
        return None if vector is None else vector * FLIP

    return Reach(reach.position * FLIP, flipped(reach.pointing), flipped(reach.palm), reach.swivel)


@examples(150, derandomize=True)
@given(reach=reaches, start=shares)
def test_ranges_hold_and_the_residual_is_that_of_the_angles(reach: Reach, start: Floats) -> None:
    solution = solve(LEFT, reach, start=_posture(start))
    assert np.all(LEFT.lower <= solution.angles)
    assert np.all(solution.angles <= LEFT.upper)
    assert abs(solution.residual - np.linalg.norm(LEFT.hand(solution.angles) - reach.position)) < 1e-12
    assert (solution.pointing_error is None) == (reach.pointing is None)
    assert (solution.palm_error is None) == (reach.palm is None)


@examples(80, derandomize=True)
@given(reach=reaches, start=shares)
def test_the_right_arm_mirrors_the_left_and_asking_twice_changes_nothing(reach: Reach, start: Floats) -> None:
    left = solve(LEFT, reach, start=_posture(start))
    right = solve(RIGHT, _mirrored(reach), start=_posture(start))
    assert np.abs(left.angles - right.angles).max() < 1e-9
    assert solve(LEFT, reach, start=_posture(start)).angles.tobytes() == left.angles.tobytes()


@examples(150, derandomize=True)
@given(share=shares, start=shares)
def test_what_a_posture_holds_is_reached(share: Floats, start: Floats) -> None:
    solution = solve(LEFT, Reach(LEFT.hand(_posture(share))), start=_posture(start))
    assert solution.residual < 2e-3


@examples(80, derandomize=True)
@given(start=shares, target=positions)
def test_masses_keep_both_ends_and_never_take_more_than_their_rounds(start: Floats, target: Floats) -> None:
    linkage = linkage_of(LEFT)
    points = linkage.walk(_posture(start).tolist(), 3)[1]
    lengths = [link.length for link in linkage.links[:3]]
    settled = settle_masses(points, lengths, tuple(target.tolist()))
    assert settled.points[0] == points[0]
    assert distance(settled.points[0], settled.points[-1]) <= sum(lengths) * (1 + 1e-12)
    assert np.all(np.isfinite(settled.points))


@examples(60, derandomize=True)
@given(left=positions, right=positions)
def test_the_torso_never_turns_further_than_allowed(left: Floats, right: Floats) -> None:
    turn = np.array(lean_torso(ROBOT, {"l": left, "r": right}))
    joints = list(ROBOT.joints("torso"))
    assert np.all(np.abs(turn) <= LARGEST_TURN)
    assert np.all((ROBOT.skeleton.lower[joints] <= turn) & (turn <= ROBOT.skeleton.upper[joints]))
