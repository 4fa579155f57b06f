import numpy as np
import pytest

from kinesic.body.linear_program import SparseMatrix, solve_linear_program

INFINITE_BOUNDS = np.full(2, np.inf)  # upper bounds of two unbounded variables


def random_matrix(seed: int) -> SparseMatrix:
    """Return a random sparse matrix with some entries given in several parts."""
    rng = np.random.default_rng(seed)
    height, width = rng.integers(2, 9, 2).tolist()
    count = int(rng.integers(1, 2 * height * width))
    return SparseMatrix(
        rng.integers(0, height, count), rng.integers(0, width, count), rng.normal(size=count), (height, width)
    )


def full(matrix: SparseMatrix):
    dense = np.zeros(matrix.shape)
    np.add.at(dense, (matrix.rows, matrix.columns), matrix.values)
    return dense


@pytest.mark.parametrize("seed", range(8))
def test_sparse_matrix_product_negation_and_row_selection_match_the_dense_matrix(seed: int):
    matrix, rng = random_matrix(seed), np.random.default_rng(seed)
    vector, selected = rng.normal(size=matrix.shape[1]), rng.random(matrix.shape[0]) < 0.5
    np.testing.assert_allclose(matrix @ vector, full(matrix) @ vector)
    np.testing.assert_allclose(full(-matrix), -full(matrix))
    part = matrix.select_rows(selected)
    assert part.shape == (int(selected.sum()), matrix.shape[1])
    np.testing.assert_allclose(full(part), full(matrix)[selected])


@pytest.mark.parametrize("seed", range(8))
def test_compressed_columns_of_a_sparse_matrix_match_scipy(seed: int):
    scipy = pytest.importorskip("scipy", reason="SciPy, the oracle of this test, is not installed")
    matrix = random_matrix(seed)
    starts, rows, values = matrix.compress()
    other = scipy.sparse.csc_array((matrix.values, (matrix.rows, matrix.columns)), shape=matrix.shape)
    other.sum_duplicates()
    np.testing.assert_array_equal(starts, other.indptr)
    np.testing.assert_array_equal(rows, other.indices)
    np.testing.assert_allclose(values, other.data)


def test_solution_of_a_linear_program_lies_at_a_vertex_of_the_feasible_region():
    matrix = SparseMatrix(np.array([0, 0, 1]), np.array([0, 1, 1]), np.array([1.0, 2.0, 1.0]), (2, 2))
    bounds, ranges = (np.array([4.0, -np.inf]), np.array([np.inf, 1.5])), (np.zeros(2), INFINITE_BOUNDS)
    assert solve_linear_program(np.array([1.0, 1.0]), matrix, bounds, ranges) == pytest.approx([1.0, 1.5])
    assert solve_linear_program(np.array([1.0, 3.0]), matrix, bounds, ranges) == pytest.approx([4.0, 0.0])


@pytest.mark.parametrize("costs", [(1.0, 1.0), (-1.0, 0.0)], ids=["contradiction", "no least cost"])
def test_infeasible_or_unbounded_linear_program_returns_none(costs):
    lowest = 3.0 if costs[0] > 0 else 0.0
    matrix = SparseMatrix(np.array([0]), np.array([1]), np.ones(1), (1, 2))
    bounds = np.full(1, -np.inf), np.full(1, 2.0)
    assert solve_linear_program(np.array(costs), matrix, bounds, (np.full(2, lowest), INFINITE_BOUNDS)) is None


@pytest.mark.parametrize("seed", range(20))
def test_linear_program_cost_and_feasibility_match_scipy(seed: int):
    optimize = pytest.importorskip("scipy.optimize", reason="SciPy, the oracle of this test, is not installed")
    matrix, rng = random_matrix(seed), np.random.default_rng(seed)
    height, width = matrix.shape
    lower, costs = rng.uniform(-1.0, 0.0, height), rng.uniform(0.1, 1.0, width)
    bounds = np.where(rng.random(height) < 0.3, -np.inf, lower), lower + rng.uniform(0.0, 1.0, height)
    ranges = rng.uniform(-1.0, 0.5, width), np.full(width, np.inf)
    found = solve_linear_program(costs, matrix, bounds, ranges)
    other = optimize.milp(
        costs,
        bounds=optimize.Bounds(*ranges),
        constraints=optimize.LinearConstraint(full(matrix), *bounds),
    )
    assert (found is None) == (other.x is None)
    if found is not None:
        assert costs @ found == pytest.approx(other.fun, abs=1e-6)


def test_linear_program_solver_prints_nothing(capfd):
    matrix = SparseMatrix(np.zeros(1, dtype=np.intp), np.zeros(1, dtype=np.intp), np.ones(1), (1, 1))
    solve_linear_program(np.ones(1), matrix, (np.ones(1), np.ones(1)), (np.zeros(1), np.ones(1)))
    assert capfd.readouterr() == ("", "")
