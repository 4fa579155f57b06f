"""Properties of the thesis solvers over random ball chains and targets."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.ik.thesis.boxes import EulerBoxes
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.solve import Method, solve_ball_chain

from ...examples import examples

number = st.floats(-1.0, 1.0)
lengths = st.lists(st.floats(0.05, 1.0), min_size=1, max_size=8)
places = st.tuples(number, number, number).map(np.array)
methods = st.sampled_from(["force", "position", "direct"])
boxes = st.tuples(*[st.floats(0.05, 1.5)] * 3).map(np.array)
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])


@examples(80, derandomize=True)
@given(sizes=lengths, share=places, method=methods)
def test_ball_chain_solution_keeps_bone_lengths_and_reports_its_residual(
    sizes: list[float], share: np.ndarray, method: Method
):
    chain = BallChain.curved(sizes)
    target = 1.3 * chain.size * share
    relaxed = solve_ball_chain(chain, target, method=method)
    assert np.linalg.norm(np.diff(relaxed.points, axis=0), axis=1) == pytest.approx(chain.lengths)
    assert relaxed.points[0].tolist() == chain.points[0].tolist()
    assert relaxed.residual == pytest.approx(np.linalg.norm(relaxed.points[-1] - target))
    assert relaxed.residual >= np.linalg.norm(target) - chain.size - 1e-9
    assert relaxed.rotations @ relaxed.rotations.transpose(0, 2, 1) == pytest.approx(
        np.broadcast_to(np.eye(3), relaxed.rotations.shape), abs=1e-9
    )


@examples(40, derandomize=True)
@given(sizes=lengths, share=places, method=methods, box=boxes)
def test_ball_chain_solution_is_within_joint_limits(
    sizes: list[float], share: np.ndarray, method: Method, box: np.ndarray
):
    limits = EulerBoxes.of(-box, box, joints=len(sizes))
    rest = BallChain.curved(sizes)
    relaxed = solve_ball_chain(BallChain.of(rest.points, limits=limits), rest.size * share, method=method)
    assert limits.excess(relaxed.rotations) < 1e-9


@examples(40, derandomize=True)
@given(sizes=lengths, share=places, method=methods)
def test_ball_chain_solution_is_deterministic_and_mirrors_with_its_target(
    sizes: list[float], share: np.ndarray, method: Method
):
    chain = BallChain.curved(sizes)
    target = chain.size * share
    first, again = (solve_ball_chain(chain, target, method=method) for _ in range(2))
    assert first.points.tobytes() == again.points.tobytes()
    mirrored = solve_ball_chain(chain, target * MIRROR_SIGNS, method=method)
    assert mirrored.points * MIRROR_SIGNS == pytest.approx(first.points, abs=1e-6 * chain.size)
