"""Which designs are not beaten by another one in anything that counts."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.studies.designs.trial import Trial


@dataclass(frozen=True)
class Goal:
    """What a design is judged by."""

    head: str  # of its column
    unit: str
    step: float  # what is less apart counts as equal
    value: Callable[[Trial], float]  # in the unit; less is better
    more: bool = False  # more of it is better: the value is its negative


def _price(trial: Trial) -> float:
    return inf if trial.body is None or trial.body.price is None else trial.body.price


GOALS: Mapping[str, Goal] = {
    "lateness": Goal("lateness", "ms", 1.0, lambda trial: 1000 * trial.lateness),
    "violations": Goal("violations", "", 1.0, lambda trial: trial.violations),
    "torque": Goal("torque", "of stall", 0.01, lambda trial: trial.body.torque if trial.body else inf),
    "mass": Goal("mass", "kg", 0.01, lambda trial: trial.body.mass if trial.body else inf),
    "price": Goal("price", "US$", 1.0, _price),
    "sectors": Goal("sectors", "of 105", 1.0, lambda trial: -float(trial.body.sectors if trial.body else 0), more=True),
    "arm": Goal("arm", "m", 0.005, lambda trial: -(trial.body.arm_length if trial.body else 0.0), more=True),
}


def values_of(trials: Sequence[Trial]) -> Floats:
    """Tabulates (m, g) what trials are judged by, in steps; less is better."""
    rows = [[goal.value(trial) / goal.step for goal in GOALS.values()] for trial in trials]
    return np.array([[np.round(value) for value in row] for row in rows]).reshape(len(rows), len(GOALS))


def beaten_by(trials: Sequence[Trial]) -> list[list[int]]:
    """Lists for each trial those that are no worse in anything and better in something."""
    values = values_of(trials)
    return [
        [int(other) for other in np.flatnonzero((values <= values[k]).all(axis=1) & (values < values[k]).any(axis=1))]
        for k in range(len(trials))
    ]


def unbeaten(trials: Sequence[Trial]) -> list[Trial]:
    """Picks the trials that no other one beats; of those that are equal in all the one that changes least."""
    best = [trial for trial, better in zip(trials, beaten_by(trials), strict=True) if not better]
    simplest: dict[bytes, Trial] = {}
    for trial, row in zip(best, values_of(best), strict=True):
        equal = simplest.setdefault(row.tobytes(), trial)
        if len(trial.design) < len(equal.design):
            simplest[row.tobytes()] = trial
    return list(simplest.values())


def rank(trials: Sequence[Trial], base: Trial) -> list[Trial]:
    """Sorts trials, the best first: who beats the base, then who is beaten by few, then by their mean place.

    Args:
        trials: to be sorted.
        base: one of them, which shall be bettered.
    """
    values = values_of(trials)
    places = np.array([(values < row).sum(axis=0) for row in values]).mean(axis=1)
    beaten = beaten_by(trials)
    better = beaten[trials.index(base)]
    order = sorted(range(len(trials)), key=lambda k: (k not in better, len(beaten[k]), float(places[k])))
    return [trials[k] for k in order]
