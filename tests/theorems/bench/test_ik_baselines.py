"""Properties of the IK methods over random chains and targets."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bench.ik.baselines import IK_METHODS, Method, solve_chain
from kinesic.body.arrays import Floats

from ...examples import examples

number = st.floats(-1.0, 1.0)
vectors = st.tuples(number, number, number).map(np.array)
bones = st.lists(vectors.filter(lambda v: np.linalg.norm(v) > 0.05), min_size=1, max_size=12)
chains = st.tuples(vectors, bones).map(lambda parts: np.cumsum([parts[0], *parts[1]], axis=0))


@examples(150, derandomize=True)
@given(method=st.sampled_from(IK_METHODS), rest=chains, target=vectors, max_iterations=st.integers(1, 60))
def test_ik_methods_keep_bone_lengths_and_report_the_correct_residual(
    method: Method, rest: Floats, target: Floats, max_iterations: int
) -> None:
    solved = solve_chain(method, rest, 4.0 * target, max_iterations=max_iterations)
    lengths = np.linalg.norm(np.diff(rest, axis=0), axis=1)
    away = 4.0 * target - rest[0]
    far = float(np.linalg.norm(away))
    clamped = rest[0] + away * (min(1.0, lengths.sum() / far) if far > 0.0 else 1.0)
    assert (solved.points[0] == rest[0]).all()
    assert np.abs(np.linalg.norm(np.diff(solved.points, axis=0), axis=1) - lengths).max() < 1e-9
    assert np.abs(np.linalg.norm(solved.rotations, axis=1) - 1.0).max() < 1e-12
    assert abs(solved.residual * lengths.sum() - np.linalg.norm(solved.points[-1] - clamped)) < 1e-9
    assert 0 <= solved.iterations <= max_iterations


@examples(60, derandomize=True)
@given(method=st.sampled_from(IK_METHODS), rest=chains, target=vectors)
def test_iterative_ik_methods_stop_at_the_target_or_the_iteration_limit(
    method: Method, rest: Floats, target: Floats
) -> None:
    solved = solve_chain(method, rest, target, tolerance=1e-3, max_iterations=100)
    assert solved.residual <= 1e-3 or solved.iterations == 100 or method == "triangulation"
