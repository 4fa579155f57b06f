"""Moves key times as little as needed, strokes least of all: a linear program under gaps, cutting planes and bonds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.motion.keys import Keys, Pair
from kinesic.motion.trajectory import KERNEL

if KERNEL == "compiled":
    from kinesic.motion import _kernel

LATENESS = 3.0  # weight of being late over being early
BROKEN = 50.0  # weight of a bond that cannot be kept, per second
UNMOVED = 1e-7  # [s]
ROW_TOLERANCE = 1e-7  # [s], or of a plane's amount, by which a row may be missed
MAX_PUSHED_KEYS = 8e6  # keys times gaps longer than asked, beyond which keys are only made later, one after the other
BOND_SWEEPS = 8  # over all keys, in which bonds make keys later
FEW = 20_000  # entries of a program that the kernel solves sooner than HiGHS does


@dataclass(frozen=True, eq=False)
class CuttingPlane:
    """Times t with slopes @ t > bound are too short for some hinge."""

    slopes: Floats  # (m,) [1/s]
    bound: float


@dataclass(frozen=True, eq=False)
class KeyTimeProblem:
    """Key times that are sought: near the asked ones, under gaps, cuts and the bonds of the keys."""

    keys: Keys  # as asked
    gaps: Mapping[Pair, float]  # [s] least time from one key to another
    lead_in: float  # [s] by which the first key may come earlier
    cuts: Sequence[CuttingPlane] = ()  # that exclude other times; gaps alone can always be kept

    @property
    def lacking(self) -> float:
        """[s] that all gaps together are longer than asked."""
        times = self.keys.asked.tolist()
        return sum((max(0.0, gap - (times[j] - times[i])) for (i, j), gap in self.gaps.items()), 0.0)

    @property
    def is_crowded(self) -> bool:
        """Whether the exact linear program would take too long."""
        times = self.keys.asked.tolist()
        short = sum(1 for (i, j), gap in self.gaps.items() if times[j] - times[i] < gap)
        return short * len(times) > MAX_PUSHED_KEYS

    @property
    def kept_as_asked(self) -> bool:
        """Whether the asked times keep everything."""
        times = self.keys.asked.tolist()
        return (
            all(times[j] - times[i] >= gap for (i, j), gap in self.gaps.items())
            and all(times[j] - times[i] >= least for (i, j), least in self.keys.bonds.items())
            and all(float(cut.slopes @ self.keys.asked) <= cut.bound for cut in self.cuts)
        )


@dataclass(frozen=True, eq=False)
class KeyTimeProgram:
    """A problem as a linear program: costs @ x least, with lower <= matrix @ x <= upper, x >= least.

    Variables are t (m,), lateness e+ and earliness e- (m,) with t - asked = e+ - e-, and what each of b bonds lacks.
    """

    costs: Floats  # (3 m + b,)
    matrix: "scipy.sparse.csc_array"  # (g + b + c + m, 3 m + b) of gaps, bonds, cuts, and t - e+ + e-
    lower: Floats  # (g + b + c + m,)
    upper: Floats  # (g + b + c + m,)
    least: Floats  # (3 m + b,)


def state_program(problem: KeyTimeProblem) -> KeyTimeProgram:
    """Writes a problem as a linear program."""
    keys, gaps, cuts = problem.keys, problem.gaps, problem.cuts
    count, ties = len(keys.asked), len(keys.bonds)
    pairs = np.array([*gaps, *keys.bonds], dtype=np.intp).reshape(-1, 2)
    slopes = np.array([each.slopes for each in cuts]).reshape(len(cuts), count)
    cut, key = np.nonzero(slopes)
    first, bond, last = np.arange(len(pairs)), np.arange(ties), len(pairs) + len(cuts) + np.arange(count)
    row = np.concatenate([first, first, len(gaps) + bond, len(pairs) + cut, last, last, last])
    column = np.concatenate([*pairs.T, 3 * count + bond, key, np.arange(3 * count)])
    one = np.ones(count)
    value = np.concatenate([np.ones(len(pairs)), -np.ones(len(pairs) + ties), slopes[cut, key], one, -one, one])
    shape = (len(pairs) + len(cuts) + count, 3 * count + ties)
    apart = np.array([*gaps.values(), *keys.bonds.values()])
    return KeyTimeProgram(
        costs=np.concatenate([np.zeros(count), LATENESS * keys.weights, keys.weights, np.full(ties, BROKEN)]),
        matrix=scipy.sparse.csc_array((value, (row, column)), shape=shape),
        lower=np.append(np.full(len(pairs) + len(cuts), -np.inf), keys.asked),
        upper=np.concatenate([-apart, [each.bound for each in cuts], keys.asked]),
        least=np.append(np.full(count, keys.asked[0] - problem.lead_in), np.zeros(2 * count + ties)),
    )


def relax_key_times(problem: KeyTimeProblem) -> Floats:
    """Finds the key times that are nearest to the asked ones under gaps, cuts and bonds.

    Returns:
        (m,) [s] block time.

    Raises:
        ArithmeticError: the cuts leave no times.
    """
    keys = problem.keys
    if problem.kept_as_asked:
        return keys.spread(keys.asked)
    times = _push_keys(problem) if problem.is_crowded else solve_exactly(problem)
    return keys.spread(np.where(np.abs(times - keys.asked) < UNMOVED, keys.asked, times))


def solve_exactly(problem: KeyTimeProblem) -> Floats:
    """Find the nearest key times (m,) [s] by linear programming."""
    times = _relax_few(problem)
    return _relax_many(problem) if times is None else times


def _push_keys(problem: KeyTimeProblem) -> Floats:
    """Delay each key as far as the gaps before it require.

    Bonds are kept as far as a few sweeps can. The work is linear in the number of keys. Cuts are not used for the
    search, only checked.

    Raises:
        ArithmeticError: the times do not keep a cut.
    """
    times, pairs = problem.keys.asked.tolist(), sorted(problem.gaps.items())
    for sweep in range(BOND_SWEEPS + 1):
        for (i, j), gap in pairs:
            times[j] = max(times[j], times[i] + gap)
        late = [(j, times[i] + least) for (i, j), least in problem.keys.bonds.items() if times[i] + least > times[j]]
        if not late or sweep == BOND_SWEEPS:
            break
        for j, time in late:
            times[j] = max(times[j], time)
    found = np.array(times)
    if any(float(cut.slopes @ found) > cut.bound for cut in problem.cuts):
        raise ArithmeticError("no key times: these cuts need an exact solution, for which there are too many keys")
    return found


def _relax_few(problem: KeyTimeProblem) -> Floats | None:
    """Finds the times with the kernel; None where there is none, or too many keys, or no times."""
    keys, pairs = problem.keys, [*problem.gaps, *problem.keys.bonds]
    count = len(keys.asked)
    if KERNEL == "numpy" or count * (len(pairs) + len(problem.cuts) + count) > FEW:
        return None
    rows = len(pairs) + len(problem.cuts)
    shares = np.zeros((rows + count, count))
    before, after = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    shares[np.arange(len(pairs)), before] = 1.0
    shares[np.arange(len(pairs)), after] -= 1.0
    if problem.cuts:
        shares[len(pairs) : rows] = [cut.slopes for cut in problem.cuts]
    shares[rows:] = -np.eye(count)
    apart, bounds = [*problem.gaps.values(), *keys.bonds.values()], [cut.bound for cut in problem.cuts]
    penalties = np.full(len(shares), np.inf)
    penalties[len(problem.gaps) : len(pairs)] = BROKEN
    limits = np.concatenate([-np.array(apart), bounds, np.full(count, problem.lead_in - keys.asked[0])])
    broken = shares @ keys.asked - limits
    moved = _kernel.move_keys(shares, broken, LATENESS * keys.weights, keys.weights, penalties)
    if moved is None or (shares @ moved > ROW_TOLERANCE - broken)[np.isinf(penalties)].any():
        return None
    return keys.asked + moved


def _relax_many(problem: KeyTimeProblem) -> Floats:
    """Finds the times with HiGHS, which looks at no more than the entries that are not 0."""
    program = state_program(problem)
    result = scipy.optimize.milp(  # which has no integers here, and reads a program in half the time of `linprog`
        program.costs,
        bounds=scipy.optimize.Bounds(program.least, np.inf),
        constraints=scipy.optimize.LinearConstraint(program.matrix, program.lower, program.upper),
    )
    if result.x is None:
        raise ArithmeticError(f"no key times: {result.message}")
    return np.array(result.x[: len(problem.keys.asked)])


def strain(keys: Keys, times: Floats) -> float:
    """Computes what moving the keys to times (m,) [s] costs: the sum that `relax_key_times` makes least."""
    late = times - keys.asked
    lacking = sum(max(least - float(times[j] - times[i]), 0.0) for (i, j), least in keys.bonds.items())
    return float(keys.weights @ np.where(late > 0.0, LATENESS * late, -late)) + BROKEN * lacking
