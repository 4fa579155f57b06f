"""Sparse matrices, and linear programs solved by HiGHS."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices


@dataclass(frozen=True, eq=False)
class SparseMatrix:
    """Sparse matrix in coordinate format, in which duplicate entries add up."""

    rows: Indices  # (e,)
    columns: Indices  # (e,)
    values: Floats  # (e,)
    shape: tuple[int, int]  # m, n

    def __neg__(self) -> "SparseMatrix":
        return SparseMatrix(self.rows, self.columns, -self.values, self.shape)

    def __matmul__(self, vector: Floats) -> Floats:
        """Return the product of the matrix and a vector (n,)."""
        return np.asarray(np.bincount(self.rows, self.values * vector[self.columns], self.shape[0]), dtype=np.float64)

    def select_rows(self, selected: Flags) -> "SparseMatrix":
        """Return the matrix of the rows with a True flag (m,)."""
        kept, numbers = selected[self.rows], np.cumsum(selected) - 1
        shape = (int(selected.sum()), self.shape[1])
        return SparseMatrix(numbers[self.rows[kept]], self.columns[kept], self.values[kept], shape)

    def compress(self) -> tuple[Indices, Indices, Floats]:
        """Return the CSC format: column starts, row indices and values."""
        height, width = self.shape
        places, entry = np.unique(self.columns * height + self.rows, return_inverse=True)
        columns, rows = np.divmod(places, height)
        sums: Floats = np.bincount(entry, self.values, len(places)).astype(np.float64, copy=False)
        return columns.searchsorted(np.arange(width + 1)), rows, sums


def solve_linear_program(
    costs: Floats, matrix: SparseMatrix, bounds: tuple[Floats, Floats], ranges: tuple[Floats, Floats]
) -> Floats | None:
    """Return the variables (n,) of minimum cost, or None without an optimum.

    They lie at a vertex of the feasible set.

    Args:
        costs: (n,) of the variables.
        matrix: (m, n) whose product with the variables is bounded.
        bounds: (m,) lower and upper, of the product.
        ranges: (n,) lower and upper, of the variables.
    """
    import highspy  # noqa: PLC0415 - takes longer to import than a gesture takes to plan, and few plans need it

    from kinesic.body.quiet_highs import QuietHighs  # noqa: PLC0415 - imports highspy

    program = highspy.HighsLp()
    program.num_row_, program.num_col_ = matrix.shape
    program.col_cost_ = costs
    program.row_lower_, program.row_upper_ = bounds
    program.col_lower_, program.col_upper_ = ranges
    program.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    starts, rows, program.a_matrix_.value_ = matrix.compress()
    program.a_matrix_.start_, program.a_matrix_.index_ = starts.astype(np.int32), rows.astype(np.int32)
    solver = QuietHighs()
    solver.passModel(program)
    solver.run()
    is_optimal = solver.getModelStatus() == highspy.HighsModelStatus.kOptimal
    return np.array(solver.getSolution().col_value) if is_optimal else None
