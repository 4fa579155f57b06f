from typing import cast, get_args

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic.bench.ik.baselines import METHODS, MOST, TOLERANCE, Method, Solved, curved, run_chain, solve_chain
from kinesic.body.arrays import Floats
from kinesic.ik import KERNEL

if KERNEL == "compiled":
    from kinesic.ik import _kernel

compiled = pytest.mark.skipif(KERNEL != "compiled", reason="the baselines exist only in the compiled kernel")
every_method = pytest.mark.parametrize("method", METHODS)

# Share of reachable targets that each solves within 300 iterations: a little below what 2000 targets show. Masses that
# swing are chaotic where a chain is pressed together: the last bit of a target decides whether it is one of the few
# that are missed, so that a share is all that holds on every processor.
SHARES = {
    "force_verlet": {6: 0.99, 10: 0.98, 20: 0.98, 32: 0.98},
    "pinned_verlet": {6: 0.99, 10: 0.98, 20: 0.98, 32: 0.98},
    "tridiagonal": {6: 0.99, 10: 0.99, 20: 0.99, 32: 0.97},
    "ccd": {6: 0.97, 10: 0.93, 20: 0.7, 32: 0.5},
    "transpose": {6: 0.93, 10: 0.84, 20: 0.75, 32: 0.75},
}


def targets(count: int, nearest: float, farthest: float, seed: int) -> Floats:
    """Even in volume between two spheres around the base."""
    random = default_rng(seed)
    lines = random.normal(size=(count, 3))
    far = np.cbrt(random.uniform(nearest**3, farthest**3, count))
    return np.asarray(lines / np.linalg.norm(lines, axis=1)[:, None] * far[:, None])


def rebuilt(rest: Floats, solved: Solved) -> Floats:
    """The chain's points from its rotations alone."""
    points, frame = [rest[0]], Rotation.identity()
    for bone, turn in zip(np.diff(rest, axis=0), solved.rotations, strict=True):
        frame = frame * Rotation.from_quat(turn, scalar_first=True)
        points.append(points[-1] + frame.apply(bone))
    return np.array(points)


@compiled
def test_the_kernel_knows_the_methods_by_the_same_names() -> None:
    assert tuple(_kernel.chain_methods()) == METHODS == get_args(Method)


@compiled
@every_method
def test_each_solves_its_share_of_reachable_targets(method: Method) -> None:
    for bones in (6, 10, 20, 32):
        rest = curved(bones, bend=min(np.pi / 18.0, np.pi / (2 * bones)))
        runs = run_chain(method, rest, targets(200, 0.1, 0.97, 71))
        assert (runs.residuals <= TOLERANCE).mean() >= SHARES.get(method, {}).get(bones, 0.995), bones
        assert (runs.residuals < 0.1).mean() >= 0.99, bones
        assert runs.iterations.max() <= MOST, bones
        assert (runs.nanoseconds > 0.0).all(), bones


@compiled
@every_method
def test_rotations_rebuild_the_points_and_bones_keep_their_length(method: Method) -> None:
    rest = curved(10) * 0.7 + np.array([0.1, -0.2, 1.0])
    lengths = np.linalg.norm(np.diff(rest, axis=0), axis=1)
    for target in rest[0] + 0.7 * targets(20, 0.0, 1.6, 5):
        solved = solve_chain(method, rest, target)
        points = rebuilt(rest, solved)
        away = target - rest[0]
        clamped = rest[0] + away * min(1.0, 0.7 / float(np.linalg.norm(away)))
        assert np.abs(points - solved.points).max() < 1e-12
        assert np.abs(np.linalg.norm(np.diff(points, axis=0), axis=1) - lengths).max() < 1e-9
        assert solved.residual == pytest.approx(np.linalg.norm(points[-1] - clamped) / 0.7, abs=1e-12)
        assert (solved.points[0] == rest[0]).all()


@compiled
@every_method
def test_the_same_bytes_again(method: Method) -> None:
    goals = targets(10, 0.1, 1.5, 9)
    once, again = (run_chain(method, curved(6), goals) for _ in range(2))
    assert once.residuals.tobytes() == again.residuals.tobytes()
    assert once.iterations.tobytes() == again.iterations.tobytes()
    first, second = (solve_chain(method, curved(6), goals[0]) for _ in range(2))
    assert first.points.tobytes() == second.points.tobytes()
    assert first.rotations.tobytes() == second.rotations.tobytes()


@compiled
@every_method
def test_unreachable_targets_end_near_the_stretched_chain(method: Method) -> None:
    runs = run_chain(method, curved(6), targets(50, 1.02, 2.0, 3))
    assert np.isfinite(runs.residuals).all()
    assert runs.iterations.max() <= MOST
    slow = method in ("ccd", "transpose")  # both creep where the chain is straight
    assert np.median(runs.residuals) < (0.1 if slow else 1e-2)


@compiled
@every_method
def test_short_chains_are_served(method: Method) -> None:
    """A single bone can but point at its target; two and three reach any of the middle distance."""
    for bones in (1, 2, 3):
        runs = run_chain(method, curved(bones, bend=np.pi / (2 * bones)), targets(50, 0.4, 0.8, 4))
        assert np.isfinite(runs.residuals).all(), bones
        assert np.median(runs.residuals) < (0.7 if bones == 1 else TOLERANCE), bones
        assert runs.residuals.max() < (1.0 if bones == 1 else 0.1), bones


@compiled
@every_method
def test_hard_places_do_not_crash(method: Method) -> None:
    straight = curved(6, bend=0.0)
    for rest in (straight, curved(6), curved(6, bend=np.pi)):
        for target in (rest[0], rest[-1], -rest[-1], rest[1], 0.5 * straight[-1], 1e60 * rest[-1]):
            solved = solve_chain(method, rest, target)
            assert np.isfinite(solved.points).all()
            assert np.isfinite(solved.rotations).all()


@compiled
@every_method
def test_a_chain_at_its_target_has_nothing_to_do(method: Method) -> None:
    rest = curved(6)
    solved = solve_chain(method, rest, rest[-1])
    assert solved.iterations == 0
    assert np.abs(solved.points - rest).max() < 1e-15
    assert solve_chain(method, rest, np.array([0.0, 0.3, 0.4]), most=0).iterations == 0


@compiled
@every_method
def test_neither_scale_nor_place_matters(method: Method) -> None:
    rest, place = curved(6), np.array([3.0, -2.0, 1.0])
    for target in targets(5, 0.2, 0.9, 8):
        here = solve_chain(method, rest, target)
        there = solve_chain(method, 1000.0 * (rest + place), 1000.0 * (target + place))
        assert here.iterations == there.iterations
        near = 1e-8 if method == "triangulation" else 1e-10  # a cosine near one knows its sine to 1e-8 only
        assert np.abs(there.points / 1000.0 - place - here.points).max() < near


@compiled
@pytest.mark.parametrize(("small", "large"), [("pinv", "pinv_svd"), ("dls", "dls_dense")])
def test_general_algebra_gives_the_answer_of_the_3_by_3(small: Method, large: Method) -> None:
    for target in targets(20, 0.1, 0.9, 6):
        quick, slow = (solve_chain(method, curved(10), target) for method in (small, large))
        assert quick.iterations == slow.iterations
        assert np.abs(quick.points - slow.points).max() < 1e-9


@compiled
def test_damped_least_squares_is_that_of_the_books() -> None:
    """The same iteration written with matrices and SciPy's rotations."""
    rest, target, damping = curved(6), np.array([0.2, 0.3, -0.5]), 0.05
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
    assert np.abs(solve_chain("dls", rest, target, tolerance=1e-15, most=3).points - points).max() < 1e-12


@compiled
def test_triangulation_needs_one_pass() -> None:
    runs = run_chain("triangulation", curved(10), targets(100, 0.1, 0.99, 2), tolerance=1e-7)
    assert (runs.iterations == 1).all()
    assert runs.residuals.max() < 1e-7


@compiled
def test_springs_agree_on_where_the_chain_rests() -> None:
    """Three ways to relax the same springs: different speed, the same bones without stretch."""
    for method in ("force_verlet", "pinned_verlet", "tridiagonal"):
        solved = solve_chain(cast(Method, method), curved(6), np.array([0.3, 0.4, 0.1]), tolerance=1e-8, most=1000)
        assert solved.residual <= 1e-8


@compiled
def test_bad_input_is_told_what_would_work() -> None:
    rest, target = curved(3), np.array([0.2, 0.3, 0.1])
    with pytest.raises(ValueError, match=r"method \"jump\" is unknown; known are .*fabrik.*sdls"):
        solve_chain(cast(Method, "jump"), rest, target)
    with pytest.raises(ValueError, match=r"point 0 of target is \[nan, 0.0, 0.0\]"):
        solve_chain("ccd", rest, np.array([np.nan, 0.0, 0.0]))
    with pytest.raises(ValueError, match="point 1 of targets"):
        run_chain("ccd", rest, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, np.inf]]))
    with pytest.raises(ValueError, match="bone 1 of rest has no length"):
        solve_chain("ccd", rest[[0, 1, 1, 2]], target)
    with pytest.raises(ValueError, match="rest has 34 points; a chain has 2 to 33"):
        solve_chain("ccd", curved(33), target)
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
    with pytest.raises(ValueError, match="most is -1"):
        run_chain("ccd", rest, target[None], most=-1)


def test_without_the_kernel_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kinesic.bench.ik.baselines.KERNEL", "numpy")
    with pytest.raises(RuntimeError, match=r"C\+\+ compiler"):
        solve_chain("ccd", curved(3), np.zeros(3))


def test_the_rest_is_a_gentle_curve_of_length_one() -> None:
    bones = np.diff(curved(6), axis=0)
    assert np.linalg.norm(bones, axis=1) == pytest.approx(np.full(6, 1.0 / 6.0))
    assert (bones[1:] * bones[:-1]).sum(axis=1) * 36.0 == pytest.approx(np.full(5, np.cos(np.radians(10.0))))
