"""Postures as arrays: what each hinge has to pass, and what it costs to move a key in time."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.controller.bonds import Bond
from kinesic.controller.postures import LEAST_GAP, Posture

Pair = tuple[int, int]  # two keys, the earlier first

TURNING_ROOM = 1e-3  # [rad] so that control points may lie beyond a key at the end of a range
HOLD = 1e-9  # [rad] keys nearer than this are a hold
SAME = 1e-6  # [s]
WEIGHTS = {"strokeStart": 5.0, "stroke": 5.0, "strokeEnd": 5.0, "ready": 0.3, "relax": 0.3}
WEIGHT_ELSE = 0.05


@dataclass(frozen=True, eq=False)
class Keys:
    """Postures as arrays."""

    asked: Floats  # (m,) [s] block time
    angles: Floats  # (m, n) [rad]
    keyed: Flags  # (m, n)
    weights: Floats  # (m,) of moving a key, per second
    gaps: Mapping[Pair, float]  # [s] least time between keys that follow one another in a hinge or a behaviour
    bonds: Mapping[Pair, float]  # [s] least time from one key to another, either order, that BML asks for

    @classmethod
    def of(cls, postures: tuple[Posture, ...], limits: Limits, bonds: tuple[Bond, ...] = ()) -> "Keys":
        """Keys weigh as their heaviest sync point, and keep room to turn back at the ends of a hinge's range."""
        room = np.minimum(TURNING_ROOM, (limits.upper - limits.lower) / 2)
        angles = np.clip([posture.angles for posture in postures], limits.lower + room, limits.upper - room)
        keyed = np.array([posture.keyed for posture in postures], dtype=np.bool_)
        row_of = {sync: row for row, posture in enumerate(postures) for sync in posture.syncs}
        ties = {
            (row_of[bond.earlier], row_of[bond.later]): bond.least
            for bond in bonds
            if bond.earlier in row_of and bond.later in row_of and row_of[bond.earlier] != row_of[bond.later]
        }
        return cls(
            sealed([posture.time for posture in postures]),
            sealed(angles),
            keyed,
            sealed([_weight(posture) for posture in postures]),
            dict.fromkeys(_followers(postures, keyed), LEAST_GAP),
            ties,
        )

    @property
    def spaced(self) -> bool:
        """Whether the asked times leave a gap between keys of the same hinge or behaviour."""
        return all(self.asked[j] - self.asked[i] >= gap - SAME for (i, j), gap in self.gaps.items())

    @cached_property
    def own(self) -> tuple[list[int], ...]:
        """Keys of each hinge, in order."""
        return tuple([int(row) for row in np.flatnonzero(column)] for column in self.keyed.T)

    def holds(self, pair: Pair, hinge: int) -> bool:
        """Whether a hinge stays where it is between two keys, or the two are one."""
        return bool(abs(self.angles[pair[0], hinge] - self.angles[pair[1], hinge]) < HOLD)


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
