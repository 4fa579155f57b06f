"""Pareto comparison of robot designs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.studies.designs.trial import Trial


@dataclass(frozen=True)
class DesignCriterion:
    """Criterion for comparing robot designs, with unit and direction."""

    head: str  # heading of its column
    unit: str
    step: float  # smaller differences count as equal
    value: Callable[[Trial], float]  # in the unit; smaller is better
    more: bool = False  # larger values are better; `value` is negated


def _price(trial: Trial) -> float:
    return inf if trial.body is None or trial.body.price is None else trial.body.price


DESIGN_CRITERIA: Mapping[str, DesignCriterion] = {
    "lateness": DesignCriterion("lateness", "ms", 1.0, lambda trial: 1000 * trial.lateness),
    "violations": DesignCriterion("violations", "", 1.0, lambda trial: trial.violations),
    "torque": DesignCriterion("torque", "of stall", 0.01, lambda trial: trial.body.torque if trial.body else inf),
    "mass": DesignCriterion("mass", "kg", 0.01, lambda trial: trial.body.mass if trial.body else inf),
    "price": DesignCriterion("price", "US$", 1.0, _price),
    "sectors": DesignCriterion(
        "sectors", "of 105", 1.0, lambda trial: -float(trial.body.sectors if trial.body else 0), more=True
    ),
    "arm": DesignCriterion("arm", "m", 0.005, lambda trial: -(trial.body.arm_length if trial.body else 0.0), more=True),
}


def values_of(trials: Sequence[Trial]) -> Floats:
    """Return all trials' criteria in units of their smallest relevant difference, rounded.

    Smaller is better.

    Returns:
        (m, g) for m trials and the g criteria of `DESIGN_CRITERIA`.
    """
    rows = [[goal.value(trial) / goal.step for goal in DESIGN_CRITERIA.values()] for trial in trials]
    return np.array([[np.round(value) for value in row] for row in rows]).reshape(len(rows), len(DESIGN_CRITERIA))


def beaten_by(trials: Sequence[Trial]) -> list[list[int]]:
    """List the indices of the trials that dominate each trial.

    Such a trial is no worse in any criterion and better in at least one.
    """
    values = values_of(trials)
    return [
        [int(other) for other in np.flatnonzero((values <= values[k]).all(axis=1) & (values < values[k]).any(axis=1))]
        for k in range(len(trials))
    ]


def unbeaten(trials: Sequence[Trial]) -> list[Trial]:
    """Return the design trials that no other trial dominates.

    Of equal trials the one with the fewest changes is kept.
    """
    best = [trial for trial, better_than_base in zip(trials, beaten_by(trials), strict=True) if not better_than_base]
    simplest: dict[bytes, Trial] = {}
    for trial, row in zip(best, values_of(best), strict=True):
        equal = simplest.setdefault(row.tobytes(), trial)
        if len(trial.design) < len(equal.design):
            simplest[row.tobytes()] = trial
    return list(simplest.values())


def rank(trials: Sequence[Trial], base: Trial) -> list[Trial]:
    """Sort design trials, best first.

    First come trials that dominate the base, then trials dominated by few, then those with the best mean rank.

    Args:
        trials: trials to sort.
        base: one of them, to be improved.
    """
    values = values_of(trials)
    mean_ranks = np.array([(values < row).sum(axis=0) for row in values]).mean(axis=1)
    dominators = beaten_by(trials)
    better_than_base = dominators[trials.index(base)]
    order = sorted(
        range(len(trials)), key=lambda k: (k not in better_than_base, len(dominators[k]), float(mean_ranks[k]))
    )
    return [trials[k] for k in order]
