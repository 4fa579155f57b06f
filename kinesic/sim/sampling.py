"""Which postures are the worst: random ones, with the stops that often are, and a climb from the worst of them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.skeleton import Skeleton

POSTURES = 400
ROUNDS = 2  # of the climb over all hinges
CHOICES = 5  # angles of one hinge that the climb tries


@dataclass(frozen=True, eq=False)
class Extremes:
    """The largest value found for each hinge, and where."""

    values: Floats  # (n,)
    postures: Floats  # (n, n) [rad], row j: the posture that is the worst for hinge j


def random_postures(skeleton: Skeleton, count: int, *, seed: int = 0) -> Floats:
    """Rest and zero, then random postures: in every second one about half the hinges stand at a stop.

    Args:
        skeleton: whose ranges.
        count: how many, at least 2.
        seed: same seed, same postures.

    Returns:
        (count, n) [rad].
    """
    random = np.random.default_rng(seed)
    shape = (count, len(skeleton.hinges))
    postures = random.uniform(skeleton.lower, skeleton.upper, shape)
    stops = np.where(random.random(shape) < 0.5, skeleton.lower, skeleton.upper)
    stopped = (random.random(shape) < 0.5) & (np.arange(count) % 2 == 1)[:, None]
    postures[stopped] = stops[stopped]
    postures[0] = skeleton.rest
    postures[1] = skeleton.clamp(np.zeros(shape[1]))
    return postures


def extremes(skeleton: Skeleton, measure: Callable[[Floats], Floats]) -> Extremes:
    """Searches the largest value that each hinge meets anywhere in the ranges.

    Args:
        skeleton: whose ranges.
        measure: (m, n) [rad] -> (m, n), a value per hinge.

    Returns:
        The same for the same robot: the random postures are seeded.
    """
    postures = random_postures(skeleton, POSTURES)
    starts = postures[measure(postures).argmax(axis=0)]
    worst = np.array([_climb(skeleton, measure, hinge, start) for hinge, start in enumerate(starts)])
    return Extremes(sealed(measure(worst).diagonal()), sealed(worst))


def _climb(skeleton: Skeleton, measure: Callable[[Floats], Floats], hinge: int, start: Floats) -> Floats:
    """(n,) [rad] from a posture upwards, turning one hinge at a time to its best of a few angles."""
    posture = start
    for _ in range(ROUNDS):
        for turned in range(len(posture)):
            choices = np.tile(posture, (CHOICES + 1, 1))
            choices[1:, turned] = np.linspace(skeleton.lower[turned], skeleton.upper[turned], CHOICES)
            posture = choices[measure(choices)[:, hinge].argmax()]
    return posture
