"""Evenly distributed start postures within an arm's joint ranges."""

from dataclasses import dataclass
from functools import lru_cache

from kinesic.ik.arm.linkage import Linkage
from kinesic.ik.scalar3 import Vector

SEED_COUNT = 64  # number of start postures per arm


@dataclass(frozen=True)
class Seed:
    """Start posture of an arm, with its hand position."""

    angles: tuple[float, ...]  # [rad] of the hinges before the hand's own
    hand: Vector  # [m]


@lru_cache(maxsize=32)
def seeds(linkage: Linkage) -> tuple[Seed, ...]:
    """Return start postures spread evenly over the joint ranges."""
    pivots = linkage.pivots[: linkage.links[-1].first]
    ratio = _golden(len(pivots))
    postures = [
        tuple(p.lower + (p.upper - p.lower) * ((0.5 + n * ratio ** -(k + 1)) % 1.0) for k, p in enumerate(pivots))
        for n in range(1, SEED_COUNT + 1)
    ]
    return tuple(Seed(posture, linkage.hand(posture)) for posture in postures)


def _golden(dimensions: int) -> float:
    """Return the generalised golden ratio for a number of dimensions d.

    It is the root of x^(d + 1) = x + 1.
    """
    ratio = 2.0
    for _ in range(64):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1))
    return ratio
