"""Moves key times as little as needed: a linear program in which strokes weigh most and preparations give."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.motion.keys import Keys, Pair

LATENESS = 3.0  # weight of being late over being early
BROKEN = 50.0  # weight of a bond that cannot be kept, per second
SAME = 1e-7  # [s]


@dataclass(frozen=True, eq=False)
class CuttingPlane:
    """Times t with slopes @ t > bound are too short for some hinge."""

    slopes: Floats  # (m,) [1/s]
    bound: float


def relax_key_times(
    keys: Keys, gaps: Mapping[Pair, float], lead_in: float, cuts: Sequence[CuttingPlane] = ()
) -> Floats:
    """Key times as near to the asked ones as gaps, cuts and bonds allow.

    Variables are t (m,), lateness e+ and earliness e- (m,) with t - asked = e+ - e-, and what each bond lacks.

    Args:
        keys: what was asked, with its bonds.
        gaps: least time [s] from one key to another.
        lead_in: [s] by which the first key may come earlier.
        cuts: that exclude other times; gaps alone can always be kept.

    Returns:
        (m,) [s] block time.

    Raises:
        ArithmeticError: the cuts leave no times.
    """
    count, ties = len(keys.asked), len(keys.bonds)
    pairs = [*gaps, *keys.bonds]
    rows = np.zeros((len(pairs) + len(cuts), 3 * count + ties))
    for row, (i, j) in enumerate(pairs):
        rows[row, i], rows[row, j] = 1.0, -1.0
    for row, cut in enumerate(cuts, len(pairs)):
        rows[row, :count] = cut.slopes
    rows[len(gaps) : len(pairs), 3 * count :] = -np.eye(ties)
    least = np.array([*gaps.values(), *keys.bonds.values()])
    one = np.eye(count)
    result = scipy.optimize.linprog(
        np.concatenate([np.zeros(count), LATENESS * keys.weights, keys.weights, np.full(ties, BROKEN)]),
        A_ub=rows,
        b_ub=np.append(-least, [cut.bound for cut in cuts]),
        A_eq=np.hstack([one, -one, one, np.zeros((count, ties))]),
        b_eq=keys.asked,
        bounds=[(keys.asked[0] - lead_in, None)] * count + [(0.0, None)] * (2 * count + ties),
        method="highs",
    )
    if result.x is None:
        raise ArithmeticError(f"no key times: {result.message}")
    times = np.array(result.x[:count])
    return keys.spread(np.where(np.abs(times - keys.asked) < SAME, keys.asked, times))


def strain(keys: Keys, times: Floats) -> float:
    """What moving the keys to times (m,) [s] costs: the weighted sum that `relax_key_times` makes least."""
    late = times - keys.asked
    lacking = sum(max(least - float(times[j] - times[i]), 0.0) for (i, j), least in keys.bonds.items())
    return float(keys.weights @ np.where(late > 0.0, LATENESS * late, -late)) + BROKEN * lacking
