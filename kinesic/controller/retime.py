"""Moves key times as little as needed: a linear program in which strokes weigh most and preparations give."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import linprog

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.controller.postures import LEAST_GAP, Posture

Pair = tuple[int, int]  # two keys, the earlier first

PEAK_SPEED = 1.875  # of a rest-to-rest quintic, in distance / duration
PEAK_ACCELERATION = 5.7735  # in distance / duration^2
SAME = 1e-6  # [s]
RESERVE = 1.02  # on minimum durations
WEIGHTS = {"strokeStart": 5.0, "stroke": 5.0, "strokeEnd": 5.0, "ready": 0.3, "relax": 0.3}
WEIGHT_ELSE = 0.05
LATENESS = 3.0  # weight of being late over being early


@dataclass(frozen=True, eq=False)
class Keys:
    """Postures as arrays."""

    asked: Floats  # (m,) [s] block time
    angles: Floats  # (m, n) [rad]
    keyed: Flags  # (m, n)
    weights: Floats  # (m,) of moving a key, per second
    gaps: Mapping[Pair, float]  # [s] least time between keys that follow one another in a hinge or a behaviour

    @classmethod
    def of(cls, postures: tuple[Posture, ...]) -> "Keys":
        """Keys weigh as their heaviest sync point."""
        keyed = np.array([posture.keyed for posture in postures], dtype=np.bool_)
        return cls(
            sealed([posture.time for posture in postures]),
            sealed([posture.angles for posture in postures]),
            keyed,
            sealed([_weight(posture) for posture in postures]),
            dict.fromkeys(_followers(postures, keyed), LEAST_GAP),
        )

    @property
    def spaced(self) -> bool:
        """Whether the asked times leave a gap between keys of the same hinge or behaviour."""
        return all(self.asked[j] - self.asked[i] >= gap - SAME for (i, j), gap in self.gaps.items())

    def rows(self, hinge: int) -> list[int]:
        """Keys of one hinge, in order."""
        return [int(row) for row in np.flatnonzero(self.keyed[:, hinge])]


def _followers(postures: tuple[Posture, ...], keyed: Flags) -> set[Pair]:
    """Keys that follow one another in some hinge or in some behaviour."""
    chains = [[int(row) for row in np.flatnonzero(column)] for column in keyed.T]
    behaviours: dict[str, list[int]] = {}
    for row, posture in enumerate(postures):
        for behaviour in sorted({behaviour for behaviour, _ in posture.syncs}):
            behaviours.setdefault(behaviour, []).append(row)
    return {pair for chain in [*chains, *behaviours.values()] for pair in pairwise(chain)}


def _weight(posture: Posture) -> float:
    return max([WEIGHT_ELSE, *(WEIGHTS.get(sync.partition(":")[0], WEIGHT_ELSE) for _, sync in posture.syncs)])


def relaxed(keys: Keys, gaps: Mapping[Pair, float], lead_in: float) -> Floats:
    """Key times as near to the asked ones as gaps allow.

    Variables are t (m,), lateness e+ and earliness e- (m,) with t - asked = e+ - e-.

    Args:
        keys: what was asked.
        gaps: least time [s] from one key to another.
        lead_in: [s] by which the first key may come earlier.

    Returns:
        (m,) [s] block time.
    """
    count = len(keys.asked)
    rows = np.zeros((len(gaps), 3 * count))
    for row, (i, j) in enumerate(gaps):
        rows[row, i], rows[row, j] = 1.0, -1.0
    one = np.eye(count)
    result = linprog(
        np.concatenate([np.zeros(count), LATENESS * keys.weights, keys.weights]),
        A_ub=rows,
        b_ub=-np.array(list(gaps.values())),
        A_eq=np.hstack([one, -one, one]),
        b_eq=keys.asked,
        bounds=[(keys.asked[0] - lead_in, None)] * count + [(0.0, None)] * (2 * count),
        method="highs",
    )
    return np.array(result.x[:count])


def minimum_duration(distance: Floats, limits: Limits) -> Floats:
    """Shortest rest-to-rest quintic within speed and acceleration, (n,) [s] for (n,) [rad]."""
    size = np.abs(distance)
    speed, acceleration = PEAK_SPEED * size / limits.speed, np.sqrt(PEAK_ACCELERATION * size / limits.acceleration)
    return np.asarray(RESERVE * np.maximum(speed, acceleration))


def rest_to_rest(keys: Keys, limits: Limits) -> dict[Pair, float]:
    """Gaps in which every hinge can stop at every one of its keys: always enough."""
    gaps = dict(keys.gaps)
    for hinge in range(keys.angles.shape[1]):
        for before, after in pairwise(keys.rows(hinge)):
            moved = np.zeros(keys.angles.shape[1])
            moved[hinge] = keys.angles[after, hinge] - keys.angles[before, hinge]
            gaps[before, after] = max(gaps[before, after], float(minimum_duration(moved, limits)[hinge]))
    return gaps
