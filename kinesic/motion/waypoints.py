"""What each hinge passes, as arrays: angles, and in which manner."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.expressivity.style.passage import PLAIN, Passage
from kinesic.motion.easing import Easing
from kinesic.planning.postures import Posture

EASINGS: tuple[Easing, ...] = get_args(Easing)
SMOOTHEST = EASINGS.index(PLAIN.easing)

Choices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Waypoints:
    """Keys of all hinges, without their times."""

    angles: Floats  # (m, n) [rad]
    keyed: Flags  # (m, n) which hinges have a key where
    tension: Floats  # (m, n) -1..1
    continuity: Floats  # (m, n) -1..0
    bias: Floats  # (m, n) -1..1
    easing: Choices  # (m, n) of `EASINGS`, on the way to the key
    steepness: Floats  # (m, n) 1..8
    limits: Limits  # of the hinges

    @classmethod
    def of(cls, postures: Sequence[Posture], limits: Limits, *, room: Floats | float = 0.0) -> "Waypoints":
        """Keys of postures, those at the ends of the ranges moved in by some room (n,) [rad]."""
        angles = np.clip([posture.angles for posture in postures], limits.lower + room, limits.upper - room)
        keyed = np.array([posture.keyed for posture in postures], dtype=np.bool_)
        manners = np.array([_manners(posture.passages, keyed.shape[1]) for posture in postures])
        tension, continuity, bias, steepness, easing = manners.transpose(1, 0, 2)
        return cls(sealed(angles), keyed, tension, continuity, bias, easing.astype(np.intp), steepness, limits)

    def part(self, rows: Choices, hinges: Choices) -> "Waypoints":
        """Some keys of some hinges."""
        part = rows[:, None], hinges
        return Waypoints(
            self.angles[part],
            self.keyed[part],
            self.tension[part],
            self.continuity[part],
            self.bias[part],
            self.easing[part],
            self.steepness[part],
            self.limits.part(hinges),
        )

    @classmethod
    def plain(cls, angles: Floats, keyed: Flags, limits: Limits, *, tension: float = 0.0) -> "Waypoints":
        """Keys that are all passed in one way."""
        none = np.zeros(angles.shape)
        easing = np.full(angles.shape, SMOOTHEST)
        return cls(angles, keyed, none + tension, none, none, easing, none + PLAIN.steepness, limits)


@lru_cache(maxsize=256)
def _manners(passages: tuple[Passage, ...], count: int) -> Floats:
    """(5, count) tension, continuity, bias, steepness and easing of each hinge; plain where none are told."""
    told = passages or (PLAIN,) * count
    rows = [[p.tension, p.continuity, p.bias, p.steepness, EASINGS.index(p.easing)] for p in told]
    return sealed(np.transpose(rows))
