"""Searches the worst posture of each hinge: random ones, often at stops, then a climb from the worst."""

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
    """Draws random postures after rest and zero; in every second one about half the hinges stand at a stop.

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
    values = measure(postures)
    return _climbed(skeleton, measure, Extremes(values.max(axis=0), postures[values.argmax(axis=0)]))


def _climbed(skeleton: Skeleton, measure: Callable[[Floats], Floats], start: Extremes) -> Extremes:
    """From each hinge's posture upwards, turning one hinge at a time to its best of a few angles.

    All climb at once: what is to be measured for one turn is measured together.
    """
    values, postures = start.values.copy(), start.postures.copy()
    hinges = np.arange(len(values))
    choices = np.linspace(skeleton.lower, skeleton.upper, CHOICES)  # (choices, n) [rad]
    for turned in np.tile(hinges, ROUNDS):
        # where a posture already has an angle, its value is known
        climber, choice = np.nonzero(postures[:, turned, None] != choices[:, turned])
        tried = postures[climber]
        tried[:, turned] = choices[choice, turned]
        found = np.full((len(hinges), CHOICES), -np.inf)
        found[climber, choice] = measure(tried)[np.arange(len(tried)), climber]
        best = found.argmax(axis=1)
        better = np.flatnonzero(found[hinges, best] > values)
        values[better] = found[better, best[better]]
        postures[better, turned] = choices[best[better], turned]
    return Extremes(sealed(values), sealed(postures))
