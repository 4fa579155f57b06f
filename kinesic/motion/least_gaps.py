"""Finds the times that hinges need from one of their keys to the next: at full speed, and from rest to rest."""

from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.double_s import least_rest_times
from kinesic.motion.keys import Keys, Pair

Way = tuple[int, Pair]  # hinge, two of its keys that follow one another
Gaps = Mapping[Way, float]  # [s]

RESERVE = 1.02  # on durations from rest to rest
GRID = 0.04  # [s] that the grid may cost


def rest_to_rest(keys: Keys, limits: Limits) -> Gaps:
    """Computes the time in which each hinge can stop at each of its keys: always enough."""
    ways, turns = _turns(keys)
    every = RESERVE * least_rest_times(turns, limits) + GRID
    return {way: float(times[way[0]]) for way, times in zip(ways, every, strict=True)}


@lru_cache(maxsize=4)  # clashes and key times ask for those of the same keys
def full_speed(keys: Keys, limits: Limits) -> Gaps:
    """Computes the time that each hinge needs from key to key at full speed: less is never enough."""
    ways, turns = _turns(keys)
    every = np.abs(turns) / np.minimum(limits.speed, limits.duty / limits.viscous)
    return {way: float(times[way[0]]) for way, times in zip(ways, every, strict=True)}


def _turns(keys: Keys) -> tuple[list[tuple[int, Pair]], Floats]:
    """Hinges with two keys that follow one another, and (p, n) [rad] from the one to the other."""
    ways = [(hinge, pair) for hinge, own in enumerate(keys.own) for pair in pairwise(own)]
    before, after = (keys.angles[[pair[end] for _, pair in ways]] for end in (0, 1))
    return ways, after - before
