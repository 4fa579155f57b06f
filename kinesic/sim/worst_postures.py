"""Search for the worst posture of each hinge."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.skeleton import Skeleton

RANDOM_POSTURES = 400  # number of random postures before the coordinate ascent
ASCENT_ROUNDS = 2  # passes of the coordinate ascent over all hinges
ANGLES_PER_HINGE = 5  # number of angles of one hinge that the coordinate ascent tries


@dataclass(frozen=True, eq=False)
class Extremes:
    """Largest value of a quantity for each hinge, with its posture."""

    values: Floats  # (n,) largest values
    postures: Floats  # (n, n) [rad] row j: the posture with the largest value of hinge j


def random_postures(skeleton: Skeleton, count: int, *, seed: int = 0) -> Floats:
    """Return the rest and zero postures, followed by random postures.

    In every second posture about half the hinges are at a stop.

    Args:
        skeleton: Skeleton with joint ranges.
        count: Number of postures, at least 2.
        seed: Same seed, same postures.

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
    """Search for the posture that maximises a quantity of each hinge.

    Args:
        skeleton: Skeleton with joint ranges.
        measure: (m, n) [rad] -> (m, n), a value per hinge.

    Returns:
        The same for the same robot: the random postures are seeded.
    """
    postures = random_postures(skeleton, RANDOM_POSTURES)
    values = measure(postures)
    return _climb(skeleton, measure, Extremes(values.max(axis=0), postures[values.argmax(axis=0)]))


def _climb(skeleton: Skeleton, measure: Callable[[Floats], Floats], start: Extremes) -> Extremes:
    """Improve each hinge's posture by coordinate ascent over a few angles.

    All hinges climb at once: the postures of one turn are measured together.
    """
    values, postures = start.values.copy(), start.postures.copy()
    hinges = np.arange(len(values))
    choices = np.linspace(skeleton.lower, skeleton.upper, ANGLES_PER_HINGE)  # (choices, n) [rad]
    for turned in np.tile(hinges, ASCENT_ROUNDS):
        # A posture that already has an angle needs no new measurement.
        climber, choice = np.nonzero(postures[:, turned, None] != choices[:, turned])
        trial_postures = postures[climber]
        trial_postures[:, turned] = choices[choice, turned]
        candidates = np.full((len(hinges), ANGLES_PER_HINGE), -np.inf)
        candidates[climber, choice] = measure(trial_postures)[np.arange(len(trial_postures)), climber]
        best = candidates.argmax(axis=1)
        improved = np.flatnonzero(candidates[hinges, best] > values)
        values[improved] = candidates[improved, best[improved]]
        postures[improved, turned] = choices[best[improved], turned]
    return Extremes(sealed(values), sealed(postures))
