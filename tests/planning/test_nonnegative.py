import numpy as np
import pytest

from kinesic.planning.nonnegative import solve_nonnegative


def test_nonnegative_least_squares_sets_a_variable_with_a_negative_optimum_to_zero():
    np.testing.assert_allclose(solve_nonnegative(np.eye(3), np.array([2.0, -1.0, 0.5])), [2.0, 0.0, 0.5])


def test_least_squares_variable_returns_to_zero_if_later_variables_make_it_negative():
    """Use a variable that helps most at first, but not in the optimum."""
    matrix, target = np.array([[1.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.5, 0.0, 0.0]]), np.array([1.0, 1.0, -0.2])
    assert (matrix.T @ target).argmax() == 0
    np.testing.assert_allclose(solve_nonnegative(matrix, target), [0.0, 1.0, 1.0], atol=1e-12)


@pytest.mark.parametrize("shape", [(1, 1), (1, 6), (9, 3), (9, 21), (17, 44)])
@pytest.mark.parametrize("repeated", [False, True])
def test_nonnegative_least_squares_match_scipy(shape, repeated: bool):
    nnls = pytest.importorskip("scipy.optimize", reason="SciPy, the oracle of this test, is not installed").nnls
    for seed in range(10):
        rng = np.random.default_rng(seed)
        matrix, target = rng.normal(size=shape), rng.normal(size=shape[0])
        if repeated:
            matrix[:, shape[1] // 2 :] = matrix[:, : shape[1] - shape[1] // 2]
        found = solve_nonnegative(matrix, target)
        assert (found >= 0.0).all()
        assert np.linalg.norm(matrix @ found - target) <= nnls(matrix, target)[1] + 1e-9


def test_nonnegative_least_squares_of_a_negative_target_keeps_all_variables_at_zero():
    np.testing.assert_array_equal(solve_nonnegative(np.ones((2, 3)), np.array([-1.0, -1.0])), np.zeros(3))
