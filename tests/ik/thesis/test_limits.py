import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic.ik.thesis.boxes import EulerBoxes, rotation_of
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.limits import within_limits
from kinesic.ik.thesis.rotations import Carrier, stance_of
from kinesic.ik.thesis.solve import ChainStart, solve_ball_chain

EULER_LIMITS = np.radians([20.0, 60.0, 60.0])  # [rad] limit of each Euler angle to both sides


def _limited(joints: int) -> BallChain:
    rest = BallChain.curved(np.full(joints, 1.0 / joints))
    return BallChain.of(rest.points, limits=EulerBoxes.of(-EULER_LIMITS, EULER_LIMITS, joints=joints))


@pytest.mark.parametrize("joints", [3, 6, 10, 20])
def test_random_ball_joint_postures_are_clipped_to_the_limits(joints: int):
    chain, random = _limited(joints), default_rng(joints)
    ground = Carrier.at_rest(chain)
    for _ in range(10):
        wild = stance_of(chain, Rotation.random(joints, random_state=random).as_matrix(), ground)
        held = within_limits(chain, wild, random.normal(size=3), ground)
        assert chain.limits is not None
        assert chain.limits.excess(held.rotations) < 1e-9
        assert np.linalg.norm(np.diff(held.points, axis=0), axis=1) == pytest.approx(chain.lengths)


def test_ball_chain_posture_within_joint_limits_is_unchanged():
    chain = _limited(4)
    ground = Carrier.at_rest(chain)
    stance = stance_of(chain, np.tile(rotation_of(0.9 * EULER_LIMITS, "xyz"), (4, 1, 1)), ground)
    assert within_limits(chain, stance, np.ones(3), ground).rotations.tolist() == stance.rotations.tolist()


def test_parent_joint_compensates_a_clipped_joint_in_proportion_to_target_distances():
    points = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.5, 0.0, 0.0)]
    wide = [np.pi, 1.5, np.pi]
    chain = BallChain.of(points, limits=EulerBoxes.of([[-w for w in wide], [-0.1] * 3], [wide, [0.1] * 3], joints=2))
    ground = Carrier.at_rest(chain)
    bent = stance_of(chain, np.stack([np.eye(3), rotation_of(np.array([0.0, 0.0, 0.4]), "xyz")]), ground)
    target = bent.points[-1]
    held = within_limits(chain, bent, target, ground)
    ratio = np.linalg.norm(target - bent.points[1]) / np.linalg.norm(target - bent.points[0])
    assert Rotation.from_matrix(held.rotations).as_rotvec()[:, 2] == pytest.approx([0.3 * ratio, 0.1])
    cut = stance_of(chain, np.stack([np.eye(3), held.rotations[1]]), ground)
    assert np.linalg.norm(held.points[-1] - target) < 0.3 * np.linalg.norm(cut.points[-1] - target)


@pytest.mark.parametrize(("joints", "least"), [(3, 0.75), (6, 0.75), (10, 0.75), (20, 0.8)])
def test_ball_chain_with_joint_limits_reaches_most_feasible_targets(joints, least):
    chain, random, reached = _limited(joints), default_rng(40 + joints), []
    ground = Carrier.at_rest(chain)
    for _ in range(12):
        angles = random.uniform(-EULER_LIMITS, EULER_LIMITS, (joints, 3))
        wished = stance_of(chain, np.array([rotation_of(row, "xyz") for row in angles]), ground)
        relaxed = solve_ball_chain(chain, wished.points[-1], method="direct")
        assert chain.limits is not None
        assert chain.limits.excess(relaxed.rotations) < 1e-9
        assert relaxed.rounds <= 20
        reached.append(relaxed.residual <= 1e-3)
    assert np.mean(reached) >= least


def test_start_posture_outside_the_limits_gives_a_solution_within_them():
    chain = _limited(3)
    start = np.tile(rotation_of(np.array([0.0, 1.4, 0.0]), "xyz"), (3, 1, 1))
    relaxed = solve_ball_chain(chain, np.array([0.8, 0.1, 0.3]), start=ChainStart(start))
    assert chain.limits is not None
    assert chain.limits.excess(relaxed.rotations) < 1e-9
