from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.robot import Robot
from kinesic.ik.pose import PoseSolution, solve_pose

ARMS = Robot.load().arms
LEFT = ARMS["l"]


def _pose(chain: Chain, angles: Floats) -> tuple[Floats, Floats]:
    rotations, centres = chain.frames(angles)
    return centres[-2], rotations[-1]


def _check(chain: Chain, found: PoseSolution, position: Floats, rotation: Floats) -> None:
    """The reported errors are those of the angles, by another forward kinematics and another rotation formula."""
    at, turned = _pose(chain, found.angles)
    assert np.all((chain.lower <= found.angles) & (found.angles <= chain.upper))
    assert found.residual == pytest.approx(np.linalg.norm(at - position), abs=1e-9)
    assert found.turn == pytest.approx(Rotation.from_matrix(rotation @ turned.T).magnitude(), abs=1e-6)


@pytest.mark.parametrize("side", ["l", "r"])
def test_poses_of_random_postures_are_held(side):
    chain, random = ARMS[side], default_rng(21)
    for _ in range(200):
        position, rotation = _pose(chain, random.uniform(chain.lower, chain.upper))
        found = solve_pose(chain, position, rotation, start=chain.rest)
        _check(chain, found, position, rotation)
        assert found.reached


def test_cornered_starts_hold_poses_too():
    random = default_rng(22)
    for start in (LEFT.lower, LEFT.upper, np.zeros(8)):
        for _ in range(20):
            position, rotation = _pose(LEFT, random.uniform(LEFT.lower, LEFT.upper))
            assert solve_pose(LEFT, position, rotation, start=start).reached


def test_hinges_at_their_stops_hold_nearly_all_poses():
    """Where most hinges stand at a stop the search ends beside the only posture for 0.5 % of the poses."""
    random, held = default_rng(25), []
    for _ in range(60):
        share = random.uniform(0.0, 1.0, (2, len(LEFT.lower)))
        share = np.where(random.uniform(0.0, 1.0, share.shape) < 0.6, np.round(share), share)
        angles, start = LEFT.lower + share * (LEFT.upper - LEFT.lower)
        held.append(solve_pose(LEFT, *_pose(LEFT, angles), start=start).residual < 1e-3)
    assert np.mean(held) >= 0.95


def test_a_pose_that_is_held_already_changes_nothing():
    random = default_rng(23)
    for _ in range(30):
        angles = random.uniform(0.9 * LEFT.lower, 0.9 * LEFT.upper)
        found = solve_pose(LEFT, *_pose(LEFT, angles), start=angles)
        assert found.cells == 1
        assert np.abs(found.angles - angles).max() < 1e-6


def test_an_arm_without_collar_bone_and_with_other_wrists():
    random, bare = default_rng(24), replace(LEFT, joints=LEFT.joints[1:], indices=LEFT.indices[1:])
    hand = bare.joints[-1]
    swapped = replace(bare, joints=(*bare.joints[:-1], replace(hand, hinges=hand.hinges[::-1])))
    for chain in (bare, swapped):
        for _ in range(40):
            position, rotation = _pose(chain, random.uniform(chain.lower, chain.upper))
            assert solve_pose(chain, position, rotation, start=chain.rest).reached


def test_a_wrist_of_two_hinges_keeps_the_place_and_turns_as_far_as_it_can():
    elbow = LEFT.joints[2]
    stiff = replace(LEFT, joints=(*LEFT.joints[:2], replace(elbow, hinges=elbow.hinges[:1]), LEFT.joints[3]))
    position, rotation = _pose(stiff, np.array([0.1, 0.6, 0.4, -0.3, 1.2, 0.1, -0.1]))
    found = solve_pose(stiff, position, rotation, start=stiff.rest)
    _check(stiff, found, position, rotation)
    assert found.reached


def test_a_pose_beyond_reach_is_an_answer():
    position, rotation = np.array([2.0, 0.5, 0.0]), Rotation.from_rotvec([0.3, 2.0, -1.0]).as_matrix()
    found = solve_pose(LEFT, position, rotation, start=LEFT.rest)
    _check(LEFT, found, position, rotation)
    assert not found.reached


def test_half_turns_are_measured():
    position, rotation = _pose(LEFT, LEFT.rest)
    for axis in np.eye(3):
        opposite = rotation @ Rotation.from_rotvec(np.pi * axis).as_matrix()
        _check(LEFT, solve_pose(LEFT, position, opposite, start=LEFT.rest), position, opposite)


def test_wrong_questions_are_refused_and_explained():
    good, straight = np.array([0.3, 0.2, 0.0]), np.eye(3)
    with pytest.raises(ValueError, match=r"position is .*nan.*finite"):
        solve_pose(LEFT, np.array([np.nan, 0, 0]), straight, start=LEFT.rest)
    with pytest.raises(ValueError, match=r"rotation has shape \(3,\).*\(3, 3\)"):
        solve_pose(LEFT, good, np.zeros(3), start=LEFT.rest)
    with pytest.raises(ValueError, match=r"rotation is .*right-handed"):
        solve_pose(LEFT, good, np.diag([1.0, 1.0, -1.0]), start=LEFT.rest)
    with pytest.raises(ValueError, match=r"start has shape \(7,\).*\(8,\)"):
        solve_pose(LEFT, good, straight, start=np.zeros(7))
