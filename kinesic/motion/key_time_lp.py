"""Moves key times as little as needed, strokes least of all: a linear program under gaps, cutting planes and bonds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.motion.keys import Keys, Pair

LATENESS = 3.0  # weight of being late over being early
BROKEN = 50.0  # weight of a bond that cannot be kept, per second
UNMOVED = 1e-7  # [s]


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


@dataclass(frozen=True, eq=False)
class KeyTimeProgram:
    """A problem as a linear program: costs @ x least, with rows @ x <= most, balance @ x = asked times, x >= least.

    Variables are t (m,), lateness e+ and earliness e- (m,) with t - asked = e+ - e-, and what each of b bonds lacks.
    """

    costs: Floats  # (3 m + b,)
    rows: "scipy.sparse.csr_array"  # (g + b + c, 3 m + b) of gaps, bonds and cuts
    most: Floats  # (g + b + c,)
    balance: "scipy.sparse.csr_array"  # (m, 3 m + b)
    least: Floats  # (3 m + b,)


def state_program(problem: KeyTimeProblem) -> KeyTimeProgram:
    """Writes a problem as a linear program."""
    keys, gaps, cuts = problem.keys, problem.gaps, problem.cuts
    count, ties = len(keys.asked), len(keys.bonds)
    pairs = [*gaps, *keys.bonds]
    entries = [(row, end, sign) for row, pair in enumerate(pairs) for end, sign in zip(pair, (1.0, -1.0), strict=True)]
    entries += [(len(gaps) + row, 3 * count + row, -1.0) for row in range(ties)]
    for place, cut in enumerate(cuts, len(pairs)):
        entries += [(place, int(k), float(cut.slopes[k])) for k in np.flatnonzero(cut.slopes)]
    row, column, value = np.array(entries).reshape(-1, 3).T
    shape = (len(pairs) + len(cuts), 3 * count + ties)
    apart = np.array([*gaps.values(), *keys.bonds.values()])
    one = scipy.sparse.eye_array(count)
    return KeyTimeProgram(
        costs=np.concatenate([np.zeros(count), LATENESS * keys.weights, keys.weights, np.full(ties, BROKEN)]),
        rows=scipy.sparse.csr_array((value, (row.astype(np.intp), column.astype(np.intp))), shape=shape),
        most=np.append(-apart, [cut.bound for cut in cuts]),
        balance=scipy.sparse.hstack([one, -one, one, scipy.sparse.csr_array((count, ties))], format="csr"),
        least=np.append(np.full(count, keys.asked[0] - problem.lead_in), np.zeros(2 * count + ties)),
    )


def relax_key_times(problem: KeyTimeProblem) -> Floats:
    """Finds the key times that are nearest to the asked ones under gaps, cuts and bonds.

    Returns:
        (m,) [s] block time.

    Raises:
        ArithmeticError: the cuts leave no times.
    """
    keys, program = problem.keys, state_program(problem)
    result = scipy.optimize.linprog(
        program.costs,
        A_ub=program.rows,
        b_ub=program.most,
        A_eq=program.balance,
        b_eq=keys.asked,
        bounds=[(least, None) for least in program.least],
        method="highs",
    )
    if result.x is None:
        raise ArithmeticError(f"no key times: {result.message}")
    times = np.array(result.x[: len(keys.asked)])
    return keys.spread(np.where(np.abs(times - keys.asked) < UNMOVED, keys.asked, times))


def strain(keys: Keys, times: Floats) -> float:
    """Computes what moving the keys to times (m,) [s] costs: the sum that `relax_key_times` makes least."""
    late = times - keys.asked
    lacking = sum(max(least - float(times[j] - times[i]), 0.0) for (i, j), least in keys.bonds.items())
    return float(keys.weights @ np.where(late > 0.0, LATENESS * late, -late)) + BROKEN * lacking
