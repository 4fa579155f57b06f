"""Linear program for the smallest shifts of key times."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic._kernel import motion as kernel
from kinesic.body.arrays import Floats
from kinesic.body.linear_program import SparseMatrix, solve_linear_program
from kinesic.motion.double_s import IntervalDurations
from kinesic.motion.keys import Keys, Pair

LATENESS_WEIGHT = 3.0  # cost of a late key relative to an equally early one
BROKEN_BOND_WEIGHT = 50.0  # cost [1/s] of violating a precedence constraint
UNMOVED_TOLERANCE = 1e-7  # [s] smaller shifts of a key count as zero
ROW_TOLERANCE = 1e-7  # [s] accepted violation of a constraint
MAX_PROGRAM_SIZE = 8e6  # largest key count * violated gaps of an exact program; above it, keys are only delayed
BOND_SWEEPS = 8  # largest number of passes over all keys that apply precedence constraints
MAX_DENSE_ENTRIES = 20_000  # matrix entries up to which compiled code is faster than HiGHS


@dataclass(frozen=True, eq=False)
class CuttingPlane:
    """Half-space of infeasible key times t: slopes @ t > bound."""

    slopes: Floats  # (m,) [1/s]
    bound: float


@dataclass(frozen=True, eq=False)
class KeyTimeProblem:
    """Constraints on key times that should stay near the requested ones."""

    keys: Keys  # at their requested times
    gaps: Mapping[Pair, float]  # [s] minimum time from one key to another
    lead_in: float  # [s] by which the first key may come earlier
    planes: Sequence[CuttingPlane] = ()  # each excludes infeasible times; gaps alone are always feasible

    @property
    def total_deficit(self) -> float:
        """Total time [s] missing in the requested gaps."""
        times = self.keys.requested_times.tolist()
        return sum((max(0.0, gap - (times[j] - times[i])) for (i, j), gap in self.gaps.items()), 0.0)

    @property
    def is_crowded(self) -> bool:
        """Whether the exact linear program would take too long."""
        times = self.keys.requested_times.tolist()
        short_gaps = sum(1 for (i, j), gap in self.gaps.items() if times[j] - times[i] < gap)
        return short_gaps * len(times) > MAX_PROGRAM_SIZE

    @property
    def is_satisfied_as_requested(self) -> bool:
        """Whether the requested times satisfy all constraints."""
        times = self.keys.requested_times.tolist()
        return (
            all(times[j] - times[i] >= gap for (i, j), gap in self.gaps.items())
            and all(times[j] - times[i] >= least for (i, j), least in self.keys.bonds.items())
            and all(float(plane.slopes @ self.keys.requested_times) <= plane.bound for plane in self.planes)
        )


@dataclass(frozen=True, eq=False)
class KeyTimeProgram:
    """Standard form of a key-time problem as a linear program.

    Variables are t (m,), lateness e+ and earliness e- (m,) with t - requested = e+ - e-, and the violation of each of b
    bonds.
    """

    costs: Floats  # (3 m + b,)
    matrix: SparseMatrix  # (g + b + c + m, 3 m + b) of gaps, bonds, planes, and t - e+ + e-
    lower: Floats  # (g + b + c + m,)
    upper: Floats  # (g + b + c + m,)
    lower_bounds: Floats  # (3 m + b,) of the variables


def build_program(problem: KeyTimeProblem) -> KeyTimeProgram:
    """Write a key-time problem as a linear program."""
    keys, gaps, planes = problem.keys, problem.gaps, problem.planes
    count, bond_count = len(keys.requested_times), len(keys.bonds)
    pairs = np.array([*gaps, *keys.bonds], dtype=np.intp).reshape(-1, 2)
    slopes = np.array([plane.slopes for plane in planes]).reshape(len(planes), count)
    plane_row, key = np.nonzero(slopes)
    first, bond, last = np.arange(len(pairs)), np.arange(bond_count), len(pairs) + len(planes) + np.arange(count)
    row = np.concatenate([first, first, len(gaps) + bond, len(pairs) + plane_row, last, last, last])
    column = np.concatenate([*pairs.T, 3 * count + bond, key, np.arange(3 * count)])
    one = np.ones(count)
    value = np.concatenate(
        [np.ones(len(pairs)), -np.ones(len(pairs) + bond_count), slopes[plane_row, key], one, -one, one]
    )
    shape = (len(pairs) + len(planes) + count, 3 * count + bond_count)
    min_gaps = np.array([*gaps.values(), *keys.bonds.values()])
    return KeyTimeProgram(
        costs=np.concatenate(
            [np.zeros(count), LATENESS_WEIGHT * keys.weights, keys.weights, np.full(bond_count, BROKEN_BOND_WEIGHT)]
        ),
        matrix=SparseMatrix(row, column, value, shape),
        lower=np.append(np.full(len(pairs) + len(planes), -np.inf), keys.requested_times),
        upper=np.concatenate([-min_gaps, [plane.bound for plane in planes], keys.requested_times]),
        lower_bounds=np.append(
            np.full(count, keys.requested_times[0] - problem.lead_in), np.zeros(2 * count + bond_count)
        ),
    )


def solve_key_times(problem: KeyTimeProblem) -> Floats:
    """Minimise key-time shifts under minimum gaps, cutting planes and soft precedence constraints.

    With too many keys, they are delayed without optimisation.

    Returns:
        (m,) [s] block time.

    Raises:
        ArithmeticError: the planes exclude all times.
    """
    keys = problem.keys
    if problem.is_satisfied_as_requested:
        return keys.interpolate_path_times(keys.requested_times)
    times = _delay_keys(problem) if problem.is_crowded else solve_exactly(problem)
    return keys.interpolate_path_times(
        np.where(np.abs(times - keys.requested_times) < UNMOVED_TOLERANCE, keys.requested_times, times)
    )


def solve_exactly(problem: KeyTimeProblem) -> Floats:
    """Return feasible key times (m,) [s] of least shift cost."""
    times = _solve_small(problem)
    return _solve_large(problem) if times is None else times


def _delay_keys(problem: KeyTimeProblem) -> Floats:
    """Return requested key times [s], delayed to keep minimum gaps.

    Bonds are kept as far as a few sweeps can. The work is linear in the number of keys. Planes are not used for the
    search, only checked.

    Raises:
        ArithmeticError: the times violate a plane.
    """
    times, pairs = problem.keys.requested_times.tolist(), sorted(problem.gaps.items())
    for sweep in range(BOND_SWEEPS + 1):
        for (i, j), gap in pairs:
            times[j] = max(times[j], times[i] + gap)
        delayed = [(j, times[i] + least) for (i, j), least in problem.keys.bonds.items() if times[i] + least > times[j]]
        if not delayed or sweep == BOND_SWEEPS:
            break
        for j, time in delayed:
            times[j] = max(times[j], time)
    result = np.array(times)
    if any(float(plane.slopes @ result) > plane.bound for plane in problem.planes):
        raise ArithmeticError(
            "no key times: delayed keys violate a cutting plane, and there are too many keys to solve"
        )
    return result


def _solve_small(problem: KeyTimeProblem) -> Floats | None:
    """Return a small problem's key times [s], or None.

    None for a large problem, or if rounding errors make the times violate constraints.
    """
    keys, pairs = problem.keys, [*problem.gaps, *problem.keys.bonds]
    count = len(keys.requested_times)
    if count * (len(pairs) + len(problem.planes) + count) > MAX_DENSE_ENTRIES:
        return None
    rows = len(pairs) + len(problem.planes)
    coefficients = np.zeros((rows + count, count))
    before, after = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    coefficients[np.arange(len(pairs)), before] = 1.0
    coefficients[np.arange(len(pairs)), after] -= 1.0
    if problem.planes:
        coefficients[len(pairs) : rows] = [plane.slopes for plane in problem.planes]
    coefficients[rows:] = -np.eye(count)
    min_gaps, bounds = [*problem.gaps.values(), *keys.bonds.values()], [plane.bound for plane in problem.planes]
    penalties = np.full(len(coefficients), np.inf)
    penalties[len(problem.gaps) : len(pairs)] = BROKEN_BOND_WEIGHT
    limits = np.concatenate([-np.array(min_gaps), bounds, np.full(count, problem.lead_in - keys.requested_times[0])])
    violations = coefficients @ keys.requested_times - limits
    shifts = kernel.move_keys(coefficients, violations, LATENESS_WEIGHT * keys.weights, keys.weights, penalties)
    if shifts is None or (coefficients @ shifts > ROW_TOLERANCE - violations)[np.isinf(penalties)].any():
        return None
    return keys.requested_times + shifts


def _solve_large(problem: KeyTimeProblem) -> Floats:
    """Solve for a large problem's key times [s] by HiGHS.

    Raises:
        ArithmeticError: the planes exclude all times.
    """
    program = build_program(problem)
    ranges = program.lower_bounds, np.full(len(program.costs), np.inf)
    variables = solve_linear_program(program.costs, program.matrix, (program.lower, program.upper), ranges)
    if variables is None:
        raise ArithmeticError("no key times: the cutting planes contradict each other")
    return variables[: len(problem.keys.requested_times)]


def extend_gaps(gaps: Mapping[Pair, float], durations: IntervalDurations) -> dict[Pair, float]:
    """Return minimum gaps between keys [s], extended to given durations."""
    extended = dict(gaps)
    for (_, pair), duration in durations.items():
        extended[pair] = max(extended[pair], duration)
    return extended


def shift_cost(keys: Keys, times: Floats) -> float:
    """Return the weighted cost of shifting keys to times (m,) [s].

    A late key costs more than an early one, and violated bonds add to the cost.
    """
    shifts = times - keys.requested_times
    bond_deficit = sum(max(least - float(times[j] - times[i]), 0.0) for (i, j), least in keys.bonds.items())
    return (
        float(keys.weights @ np.where(shifts > 0.0, LATENESS_WEIGHT * shifts, -shifts))
        + BROKEN_BOND_WEIGHT * bond_deficit
    )
