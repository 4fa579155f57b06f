from typing import cast, get_args

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic._kernel import ik as kernel
from kinesic.bench.ik.baselines import (
    IK_METHODS,
    MAX_ITERATIONS,
    RESIDUAL_TOLERANCE,
    ChainSolution,
    Method,
    make_curved_chain,
    run_chain,
    solve_chain,
)
from kinesic.body.arrays import Floats

with_every_method = pytest.mark.parametrize("method", IK_METHODS)  # runs a test with every method

# Fraction of reachable targets solved within 300 iterations, a little below the result for 2000 targets. Moving masses
# are chaotic where a chain is compressed: the last bit of a target decides whether it is among the few missed ones, so
# only the fraction is the same on all processors.
SUCCESS_RATES = {
    "force_verlet": {6: 0.99, 10: 0.98, 20: 0.98, 32: 0.98},
    "pinned_verlet": {6: 0.99, 10: 0.98, 20: 0.98, 32: 0.98},
    "tridiagonal": {6: 0.99, 10: 0.99, 20: 0.99, 32: 0.97},
    "ccd": {6: 0.97, 10: 0.93, 20: 0.7, 32: 0.5},
    "transpose": {6: 0.93, 10: 0.84, 20: 0.75, 32: 0.75},
}


def draw_targets(count: int, nearest: float, farthest: float, seed: int) -> Floats:
    """Return targets uniform in volume between two spheres around the base."""
    random = default_rng(seed)
    directions = random.normal(size=(count, 3))
    distances = np.cbrt(random.uniform(nearest**3, farthest**3, count))
    return np.asarray(directions / np.linalg.norm(directions, axis=1)[:, None] * distances[:, None])


def rebuild_points(rest: Floats, solved: ChainSolution) -> Floats:
    """Return the chain's points computed from its rotations alone."""
    points, frame = [rest[0]], Rotation.identity()
    for bone, turn in zip(np.diff(rest, axis=0), solved.rotations, strict=True):
        frame = frame * Rotation.from_quat(turn, scalar_first=True)
        points.append(points[-1] + frame.apply(bone))
    return np.array(points)


def test_ik_kernel_and_python_have_the_same_method_names() -> None:
    assert tuple(kernel.chain_methods()) == IK_METHODS == get_args(Method)


@with_every_method
def test_ik_method_solves_at_least_its_recorded_fraction_of_targets(method: Method) -> None:
    for bones in (6, 10, 20, 32):
        rest = make_curved_chain(bones, bend=min(np.pi / 18.0, np.pi / (2 * bones)))
        runs = run_chain(method, rest, draw_targets(200, 0.1, 0.97, 71))
        assert (runs.residuals <= RESIDUAL_TOLERANCE).mean() >= SUCCESS_RATES.get(method, {}).get(bones, 0.995), bones
        assert (runs.residuals < 0.1).mean() >= 0.99, bones
        assert runs.iterations.max() <= MAX_ITERATIONS, bones
        assert (runs.nanoseconds > 0.0).all(), bones


@with_every_method
def test_ik_rotations_reproduce_the_joint_positions_and_keep_bone_lengths(method: Method) -> None:
    rest = make_curved_chain(10) * 0.7 + np.array([0.1, -0.2, 1.0])
    lengths = np.linalg.norm(np.diff(rest, axis=0), axis=1)
    for target in rest[0] + 0.7 * draw_targets(20, 0.0, 1.6, 5):
        solved = solve_chain(method, rest, target)
        points = rebuild_points(rest, solved)
        offset = target - rest[0]
        clamped = rest[0] + offset * min(1.0, 0.7 / float(np.linalg.norm(offset)))
        assert np.abs(points - solved.points).max() < 1e-12
        assert np.abs(np.linalg.norm(np.diff(points, axis=0), axis=1) - lengths).max() < 1e-9
        assert solved.residual == pytest.approx(np.linalg.norm(points[-1] - clamped) / 0.7, abs=1e-12)
        assert (solved.points[0] == rest[0]).all()


@with_every_method
def test_repeated_ik_solve_gives_bitwise_equal_results(method: Method) -> None:
    goals = draw_targets(10, 0.1, 1.5, 9)
    once, again = (run_chain(method, make_curved_chain(6), goals) for _ in range(2))
    assert once.residuals.tobytes() == again.residuals.tobytes()
    assert once.iterations.tobytes() == again.iterations.tobytes()
    first, second = (solve_chain(method, make_curved_chain(6), goals[0]) for _ in range(2))
    assert first.points.tobytes() == second.points.tobytes()
    assert first.rotations.tobytes() == second.rotations.tobytes()


@with_every_method
def test_ik_stretches_the_chain_towards_unreachable_targets(method: Method) -> None:
    runs = run_chain(method, make_curved_chain(6), draw_targets(50, 1.02, 2.0, 3))
    assert np.isfinite(runs.residuals).all()
    assert runs.iterations.max() <= MAX_ITERATIONS
    slow = method in ("ccd", "transpose")  # both converge slowly where the chain is straight
    assert np.median(runs.residuals) < (0.1 if slow else 1e-2)


@with_every_method
def test_ik_methods_solve_chains_of_one_to_three_bones(method: Method) -> None:
    """Check chains of one to three bones.

    A single bone can only point at its target; two and three bones reach any middle distance.
    """
    for bones in (1, 2, 3):
        runs = run_chain(method, make_curved_chain(bones, bend=np.pi / (2 * bones)), draw_targets(50, 0.4, 0.8, 4))
        assert np.isfinite(runs.residuals).all(), bones
        assert np.median(runs.residuals) < (0.7 if bones == 1 else RESIDUAL_TOLERANCE), bones
        assert runs.residuals.max() < (1.0 if bones == 1 else 0.1), bones


@with_every_method
def test_degenerate_ik_targets_give_finite_solutions(method: Method) -> None:
    straight = make_curved_chain(6, bend=0.0)
    for rest in (straight, make_curved_chain(6), make_curved_chain(6, bend=np.pi)):
        for target in (rest[0], rest[-1], -rest[-1], rest[1], 0.5 * straight[-1], 1e60 * rest[-1]):
            solved = solve_chain(method, rest, target)
            assert np.isfinite(solved.points).all()
            assert np.isfinite(solved.rotations).all()


@with_every_method
def test_ik_chain_already_at_its_target_needs_no_iteration(method: Method) -> None:
    rest = make_curved_chain(6)
    solved = solve_chain(method, rest, rest[-1])
    assert solved.iterations == 0
    assert np.abs(solved.points - rest).max() < 1e-15
    assert solve_chain(method, rest, np.array([0.0, 0.3, 0.4]), max_iterations=0).iterations == 0


@with_every_method
def test_ik_solution_is_independent_of_scale_and_position(method: Method) -> None:
    rest, place = make_curved_chain(6), np.array([3.0, -2.0, 1.0])
    for target in draw_targets(5, 0.2, 0.9, 8):
        here = solve_chain(method, rest, target)
        there = solve_chain(method, 1000.0 * (rest + place), 1000.0 * (target + place))
        assert here.iterations == there.iterations
        tolerance = 1e-8 if method == "triangulation" else 1e-10  # a cosine near one determines its sine only to 1e-8
        assert np.abs(there.points / 1000.0 - place - here.points).max() < tolerance


@pytest.mark.parametrize(("small", "large"), [("pinv", "pinv_svd"), ("dls", "dls_dense")])
def test_ik_methods_give_the_same_solution_with_dense_and_3_by_3_matrices(small: Method, large: Method) -> None:
    for target in draw_targets(20, 0.1, 0.9, 6):
        quick, slow = (solve_chain(method, make_curved_chain(10), target) for method in (small, large))
        assert quick.iterations == slow.iterations
        assert np.abs(quick.points - slow.points).max() < 1e-9


def test_damped_least_squares_equals_the_textbook_iteration() -> None:
    """Compare with the same iteration written with matrices and SciPy's rotations."""
    rest, target, damping = make_curved_chain(6), np.array([0.2, 0.3, -0.5]), 0.05
    points, frames = rest, [Rotation.identity()] * 6
    for _ in range(3):
        error = target - points[-1]
        error *= min(1.0, 0.5 / float(np.linalg.norm(error)))
        arms = points[-1] - points[:-1]
        jacobian = np.hstack([np.cross(np.eye(3), arm).T for arm in arms])
        turns = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping**2 * np.eye(3), error)
        turns = turns.reshape(6, 3)
        turns *= min(1.0, np.pi / 4 / np.linalg.norm(turns, axis=1).max())
        sums, carried = [], Rotation.identity()
        for turn in turns:
            carried = carried * Rotation.from_rotvec(turn)
            sums.append(carried)
        frames = [extra * frame for extra, frame in zip(sums, frames, strict=True)]
        bones = [frame.apply(bone) for frame, bone in zip(frames, np.diff(rest, axis=0), strict=True)]
        points = np.vstack([np.zeros(3), np.cumsum(bones, axis=0)])
    assert np.abs(solve_chain("dls", rest, target, tolerance=1e-15, max_iterations=3).points - points).max() < 1e-12


def test_triangulation_ik_reaches_its_target_in_one_iteration() -> None:
    runs = run_chain("triangulation", make_curved_chain(10), draw_targets(100, 0.1, 0.99, 2), tolerance=1e-7)
    assert (runs.iterations == 1).all()
    assert runs.residuals.max() < 1e-7


def test_three_spring_ik_methods_reach_a_target_within_1e_8() -> None:
    """Solve one target with three relaxation methods of the same springs."""
    for method in ("force_verlet", "pinned_verlet", "tridiagonal"):
        solved = solve_chain(
            cast(Method, method), make_curved_chain(6), np.array([0.3, 0.4, 0.1]), tolerance=1e-8, max_iterations=1000
        )
        assert solved.residual <= 1e-8


def test_invalid_ik_chain_or_target_is_rejected_with_a_remedy() -> None:
    rest, target = make_curved_chain(3), np.array([0.2, 0.3, 0.1])
    with pytest.raises(ValueError, match=r"method \"jump\" is unknown; known are .*fabrik.*sdls"):
        solve_chain(cast(Method, "jump"), rest, target)
    with pytest.raises(ValueError, match=r"point 0 of target is \[nan, 0.0, 0.0\]"):
        solve_chain("ccd", rest, np.array([np.nan, 0.0, 0.0]))
    with pytest.raises(ValueError, match="point 1 of targets"):
        run_chain("ccd", rest, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, np.inf]]))
    with pytest.raises(ValueError, match="bone 1 of rest has no length"):
        solve_chain("ccd", rest[[0, 1, 1, 2]], target)
    with pytest.raises(ValueError, match="rest has 34 points; a chain has 2 to 33"):
        solve_chain("ccd", make_curved_chain(33), target)
    with pytest.raises(ValueError, match="rest has 1 points"):
        solve_chain("ccd", rest[:1], target)
    with pytest.raises(ValueError, match="rest has 0 points"):
        solve_chain("ccd", rest[:0], target)
    with pytest.raises(ValueError, match=r"target has shape \(2,\)"):
        solve_chain("ccd", rest, target[:2])
    with pytest.raises(ValueError, match="run_chain takes many targets"):
        solve_chain("ccd", rest, np.array([target, target]))
    with pytest.raises(ValueError, match=r"targets has shape \(3,\)"):
        run_chain("ccd", rest, target)
    with pytest.raises(ValueError, match="tolerance is -1"):
        solve_chain("ccd", rest, target, tolerance=-1.0)
    with pytest.raises(ValueError, match="max_iterations is -1"):
        run_chain("ccd", rest, target[None], max_iterations=-1)


def test_curved_test_chain_has_length_one_and_equal_bends() -> None:
    bones = np.diff(make_curved_chain(6), axis=0)
    assert np.linalg.norm(bones, axis=1) == pytest.approx(np.full(6, 1.0 / 6.0))
    assert (bones[1:] * bones[:-1]).sum(axis=1) * 36.0 == pytest.approx(np.full(5, np.cos(np.radians(10.0))))
