"""Ratings of systems from pairwise choices, on the scale of Elo.

The Bradley-Terry model gives each system a strength; the probability that one is preferred to another is the logistic
function of their difference. A difference of 400 points is a ratio of 10 to 1, 200 points are 76 %. Intervals resample
whole participants, since the answers of one are correlated.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.studies.gesture_perception.answers import PairChoice

MEAN_RATING = 1000.0  # [points] mean of all ratings
POINTS_PER_UNIT = 400.0 / math.log(10.0)  # [points] Elo points per unit of the logistic scale
BOOTSTRAP_COUNT = 1000  # number of resampled sets of participants
MAX_ITERATIONS = 100  # largest number of iterations of Newton's method
STEP_TOLERANCE = 1e-8  # [logistic units] step below which the iteration has converged
MAX_STEP = 2.0  # [logistic units] largest change of a system's rating per iteration
RIDGE_WEIGHT = 1e-9  # [answers] added to the information matrix's diagonal, so that uncompared systems have a solution
PRIOR_ANSWERS = 0.5  # answers added for each side of a compared pair, if a rating would be infinite


@dataclass(frozen=True)
class Rating:
    """Rating of one system, with its confidence interval."""

    points: float  # mean of all systems: `MEAN_RATING`
    interval: tuple[float, float]  # [points] from resampled participants; NaN with one participant, or a prior
    wins: int  # number of answers that preferred the system
    answers: int  # number of answers that compared the system


@dataclass(frozen=True)
class RatingResult:
    """Ratings of all compared systems."""

    ratings: Mapping[str, Rating]  # the best first
    probabilities: Mapping[tuple[str, str], float]  # (one, other) -> probability that one is preferred
    is_bounded: bool  # False: one system always won or lost, so that the ratings have a prior
    is_connected: bool  # False: ratings of groups that were never compared with each other are not comparable


def rate_systems(choices: Sequence[PairChoice], confidence: float, *, seed: int = 0) -> RatingResult | None:
    """Rate systems by pairwise choices of participants.

    Args:
        choices: preferred and rejected system of each answer.
        confidence: probability that intervals cover.
        seed: of the resampling.

    Returns:
        None without answers.
    """
    if not choices:
        return None
    names = sorted({name for choice in choices for name in (choice.preferred, choice.rejected)})
    index = {name: k for k, name in enumerate(names)}
    people = {person: k for k, person in enumerate(dict.fromkeys(choice.participant for choice in choices))}
    wins = np.zeros((len(people), len(names), len(names)))
    for choice in choices:
        wins[people[choice.participant], index[choice.preferred], index[choice.rejected]] += 1.0
    total: Floats = wins.sum(axis=0)
    points = MEAN_RATING + POINTS_PER_UNIT * fit_strengths(total)
    is_bounded = bool(_is_bounded(total))
    is_resampled = len(people) > 1 and is_bounded  # otherwise resampling shows the prior's rating without any spread
    spread = _resample(wins, seed) if is_resampled else np.full((1, len(names)), np.nan)
    tail = 50.0 * (1.0 - confidence)
    low, high = np.percentile(spread, [tail, 100.0 - tail], axis=0)
    ratings = {
        name: Rating(
            float(points[k]), (float(low[k]), float(high[k])), int(total[k].sum()), int((total[k] + total[:, k]).sum())
        )
        for name, k in sorted(index.items(), key=lambda item: -points[item[1]])
    }
    probabilities = {
        (one, other): preference_probability(points[index[one]] - points[index[other]])
        for one in ratings
        for other in ratings
        if one != other
    }
    return RatingResult(ratings, probabilities, is_bounded, _is_connected(total))


def preference_probability(points: float) -> float:
    """Return the probability that a system is preferred, given its rating difference."""
    return float(1.0 / (1.0 + 10.0 ** (-points / 400.0)))


def fit_strengths(wins: Floats) -> Floats:
    """Return maximum-likelihood strengths (..., k) of the Bradley-Terry model.

    A system that always won or lost has no finite strength: half an answer is then added to both sides of each pair.

    Args:
        wins: (..., k, k) number of answers that prefer the system of a row to that of a column.
    """
    size = wins.shape[-1]
    counts: Floats = wins.reshape(-1, size, size).astype(float)
    prior = PRIOR_ANSWERS * (counts + np.swapaxes(counts, 1, 2) > 0)
    counts = np.where(_is_bounded(counts)[:, None, None], counts, counts + prior)
    pairs = counts + np.swapaxes(counts, 1, 2)
    strengths: Floats = np.zeros((len(counts), size))
    for _ in range(MAX_ITERATIONS):
        expected = 1.0 / (1.0 + np.exp(strengths[:, None, :] - strengths[:, :, None]))
        gradient = counts.sum(axis=2) - (pairs * expected).sum(axis=2)
        weights = pairs * expected * np.swapaxes(expected, 1, 2)
        information = np.eye(size) * (weights.sum(axis=2)[:, :, None] + RIDGE_WEIGHT) - weights + 1.0 / size
        step = np.linalg.solve(information, gradient[:, :, None])[:, :, 0]
        largest = np.abs(step).max(axis=1, keepdims=True, initial=0.0)
        strengths = strengths + step * np.minimum(1.0, MAX_STEP / np.maximum(largest, MAX_STEP))
        if largest.max() < STEP_TOLERANCE:
            break
    centred: Floats = strengths - strengths.mean(axis=1, keepdims=True)
    return centred.reshape(wins.shape[:-1])


def _resample(wins: Floats, seed: int) -> Floats:
    """Return system ratings (b, k) [points] from b resampled sets of participants."""
    generator = np.random.default_rng(seed)
    people = len(wins)
    counts = generator.multinomial(people, np.full(people, 1.0 / people), size=BOOTSTRAP_COUNT)
    totals = np.tensordot(counts.astype(float), wins, axes=1)
    ratings: Floats = MEAN_RATING + POINTS_PER_UNIT * fit_strengths(totals)
    return ratings


def _is_bounded(wins: Floats) -> NDArray[np.bool_]:
    """Return whether each table of wins determines finite strengths.

    A table is (..., k, k). Strengths are finite if each system won directly or indirectly against all that it was
    compared with.
    """
    reached = _find_paths(wins > 0) == _find_paths(wins + np.swapaxes(wins, -1, -2) > 0)
    bounded: NDArray[np.bool_] = reached.all(axis=(-2, -1))
    return bounded


def _is_connected(wins: Floats) -> bool:
    return bool(_find_paths(wins + wins.T > 0).all())


def _find_paths(links: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return flags (..., k, k) of systems linked directly or indirectly."""
    paths = links | np.eye(links.shape[-1], dtype=bool)
    for _ in range(links.shape[-1].bit_length()):
        paths = np.matmul(paths, paths)
    return paths
