"""Postures spread over an arm's ranges: where to begin again when a solve comes to rest before its target."""

from dataclasses import dataclass
from functools import lru_cache

from kinesic.ik.arm.linkage import Linkage
from kinesic.ik.scalar3 import Vector, distance

COUNT = 64


@dataclass(frozen=True)
class Seed:
    """One posture and where it holds the hand."""

    angles: tuple[float, ...]  # [rad] of the hinges before the hand's own
    hand: Vector  # [m]


@lru_cache(maxsize=32)
def seeds(linkage: Linkage) -> tuple[Seed, ...]:
    """Spreads postures evenly inside the ranges: the additive recurrence of the generalised golden ratio."""
    pivots = linkage.pivots[: linkage.links[-1].first]
    ratio = _golden(len(pivots))
    postures = [
        tuple(p.lower + (p.upper - p.lower) * ((0.5 + n * ratio ** -(k + 1)) % 1.0) for k, p in enumerate(pivots))
        for n in range(1, COUNT + 1)
    ]
    return tuple(Seed(posture, linkage.hand(posture)) for posture in postures)


def nearest_seeds(linkage: Linkage, target: Vector, count: int) -> list[Seed]:
    """Lists the seeds whose hands are nearest to a target [m], best first."""
    return sorted(seeds(linkage), key=lambda seed: distance(seed.hand, target))[:count]


def _golden(dimensions: int) -> float:
    """The root above one of x^(d + 1) = x + 1."""
    ratio = 2.0
    for _ in range(64):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1))
    return ratio
