import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.ik.thesis.boxes import EulerBoxes
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.rotations import Carrier
from kinesic.ik.thesis.solve import RELAXATION_METHODS, ChainStart, solve_ball_chain

METHOD_NAMES = list(RELAXATION_METHODS)  # names of all relaxation methods
JOINT_COUNTS = (3, 6, 10, 20)  # numbers of joints of the tested chains


def _chain(joints: int, size: float = 1.0) -> BallChain:
    return BallChain.curved(np.full(joints, size / joints))


@pytest.mark.parametrize("joints", JOINT_COUNTS)
@pytest.mark.parametrize("method", METHOD_NAMES)
def test_ball_chain_residual_is_the_end_distance_and_bones_keep_their_lengths(method, joints):
    chain, random, reached = _chain(joints), default_rng(1), []
    for _ in range(8):
        line = random.normal(size=3)
        target = random.uniform(0.2, 0.85) * line / np.linalg.norm(line)
        relaxed = solve_ball_chain(chain, target, method=method)
        reached.append(relaxed.residual <= 1e-3)
        assert relaxed.residual == pytest.approx(np.linalg.norm(relaxed.points[-1] - target))
        assert np.linalg.norm(np.diff(relaxed.points, axis=0), axis=1) == pytest.approx(chain.lengths)
        along = np.diff(relaxed.points, axis=0)
        assert (relaxed.ups * along).sum(axis=1) == pytest.approx(np.zeros(joints), abs=1e-12)
    # long chains that swing freely do not all settle
    assert np.mean(reached) >= (0.8 if joints == 20 and method != "direct" else 1.0)


@pytest.mark.parametrize("joints", JOINT_COUNTS)
@pytest.mark.parametrize("method", METHOD_NAMES)
def test_ball_joint_chain_points_straight_at_an_unreachable_target(method, joints):
    target = np.array([1.2, -0.6, 0.9])
    relaxed = solve_ball_chain(_chain(joints), target, method=method)
    distance = np.linalg.norm(target)
    assert relaxed.target == pytest.approx(target / distance)
    slack = 0.05 if joints == 20 else 0.01
    assert distance - 1.0 - 1e-9 <= relaxed.residual <= distance - 1.0 + slack


@pytest.mark.parametrize("method", METHOD_NAMES)
def test_ball_chain_solution_is_independent_of_length_scale(method):
    target = np.array([0.3, 0.4, 0.2])
    small = solve_ball_chain(_chain(6), target, method=method)
    for scale in (1e-3, 1e4):
        big = solve_ball_chain(_chain(6, scale), scale * target, method=method)
        assert big.iterations == small.iterations
        assert big.points / scale == pytest.approx(small.points, abs=1e-9)
        assert big.rotations == pytest.approx(small.rotations, abs=1e-9)
        assert big.energy == pytest.approx(small.energy, abs=1e-12)


@pytest.mark.parametrize("method", METHOD_NAMES)
@pytest.mark.parametrize("line", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -0.6, 0.8)])
def test_straight_ball_joint_chain_bends_sideways_to_reach_a_near_target(method, line):
    axis = np.array(line)
    chain = BallChain.of(np.linspace(0.0, 1.0, 7)[:, None] * axis)
    for share in (0.9, 0.5, -0.5):
        relaxed = solve_ball_chain(chain, share * axis, method=method)
        assert relaxed.residual <= 1e-3
        assert np.linalg.norm(np.cross(relaxed.points, axis), axis=1).max() > 0.05


@pytest.mark.parametrize("method", METHOD_NAMES)
def test_ball_joint_chain_reaches_a_target_at_its_base(method):
    assert solve_ball_chain(_chain(6), np.zeros(3), method=method).residual <= 1e-3


@pytest.mark.parametrize("method", METHOD_NAMES)
def test_ball_joint_chain_of_one_bone_points_at_its_target(method):
    relaxed = solve_ball_chain(
        BallChain.of([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0)]), np.array([0.0, 0.3, 0.4]), method=method
    )
    assert relaxed.points[-1] == pytest.approx([0.0, 0.3, 0.4], abs=1e-3)


@pytest.mark.parametrize("method", METHOD_NAMES)
def test_ball_joint_chain_solved_again_from_its_solution_needs_no_iterations(method):
    target = np.array([0.3, 0.4, 0.2])
    first = solve_ball_chain(_chain(6), target, method=method)
    again = solve_ball_chain(_chain(6), target, method=method, start=ChainStart(first.rotations))
    assert again.iterations == 0
    assert again.points == pytest.approx(first.points, abs=2e-3)
    near = solve_ball_chain(_chain(6), target + 0.01, method=method, start=ChainStart(first.rotations))
    assert near.iterations < first.iterations


def test_ball_joint_chain_bends_towards_the_up_vector():
    target = np.array([0.5, 0.0, 0.0])
    for up in ([0.0, 1.0, 0.0], [0.0, 0.0, -1.0]):
        relaxed = solve_ball_chain(_chain(4), target, up=np.array(up))
        assert relaxed.residual <= 1e-3
        middle = relaxed.points[1:-1].mean(axis=0)
        assert middle @ np.array(up) == pytest.approx(np.linalg.norm(middle[1:]), rel=1e-3)


def test_ball_joint_chain_on_a_moved_and_rotated_base_has_the_same_joint_rotations():
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    shift, target = np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.4, 0.2])
    here = solve_ball_chain(_chain(6), target)
    there = solve_ball_chain(_chain(6), shift + quarter @ target, start=ChainStart(carrier=Carrier(shift, quarter)))
    assert there.iterations == here.iterations
    assert there.rotations == pytest.approx(here.rotations, abs=1e-9)


def test_ball_joint_chain_keeps_joint_limits_with_every_method():
    rest = _chain(6)
    box = np.radians([10.0, 40.0, 40.0])
    chain = BallChain.of(rest.points, limits=EulerBoxes.of(-box, box, joints=6))
    for method in METHOD_NAMES:
        relaxed = solve_ball_chain(chain, np.array([0.2, 0.5, 0.3]), method=method)
        assert chain.limits is not None
        assert chain.limits.excess(relaxed.rotations) < 1e-9
        assert relaxed.residual < 0.05


@pytest.mark.parametrize(
    ("target", "given", "lesson"),
    [
        ([0.1, np.nan, 0.0], {}, r"target is \[0.1, nan, 0.0\]; it needs three finite numbers"),
        ([0.1, 0.2], {}, "target is .* three finite numbers"),
        ([0.1, 0.2, 0.3], {"up": np.array([np.inf, 0.0, 0.0])}, "up is"),
        ([0.1, 0.2, 0.3], {"method": "magic"}, "method is 'magic'; known are force, position, direct"),
        ([0.1, 0.2, 0.3], {"start": ChainStart(np.eye(3))}, r"start has the shape \(3, 3\)"),
    ],
)
def test_invalid_ball_chain_ik_arguments_raise_clear_errors(target, given, lesson):
    with pytest.raises(ValueError, match=lesson):
        solve_ball_chain(_chain(3), np.array(target), **given)
