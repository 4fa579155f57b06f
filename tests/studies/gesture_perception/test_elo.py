"""Elo ratings compared with known strengths and a logistic regression."""

from itertools import combinations
from random import Random

import numpy as np
import pytest
from scipy.optimize import minimize

from kinesic.studies.gesture_perception.answers import PairChoice
from kinesic.studies.gesture_perception.elo import fit_strengths, preference_probability, rate_systems

TRUE_RATINGS = {"captured": 1150.0, "rules": 1080.0, "beats": 960.0, "idle": 810.0}


def judge(seed: int, participants: int = 60, repetitions: int = 3, spread: float = 0.0) -> list[PairChoice]:
    """Return simulated answers of judges whose ratings vary by `spread` [points]."""
    chance, choices = Random(seed), []
    for person in range(participants):
        own = {name: rating + chance.gauss(0.0, spread) for name, rating in TRUE_RATINGS.items()}
        for one, other in combinations(TRUE_RATINGS, 2):
            for _ in range(repetitions):
                wins = chance.random() < preference_probability(own[one] - own[other])
                choices.append(PairChoice(f"p{person}", *((one, other) if wins else (other, one))))
    return choices


def test_true_elo_ratings_are_recovered_from_simulated_judges():
    result = rate_systems(judge(1), 0.95)
    assert result is not None
    assert list(result.ratings) == ["captured", "rules", "beats", "idle"]
    for name, rating in result.ratings.items():
        assert rating.points == pytest.approx(TRUE_RATINGS[name], abs=45.0)
        assert rating.answers == 60 * 3 * 3
    assert preference_probability(200.0) == pytest.approx(0.76, abs=0.001)
    assert result.probabilities["captured", "idle"] == pytest.approx(
        preference_probability(result.ratings["captured"].points - result.ratings["idle"].points)
    )


def test_fitted_elo_strengths_equal_those_of_a_logistic_regression():
    wins = np.array([[0, 7, 12, 3.0], [4, 0, 5, 9], [2, 6, 0, 1], [8, 2, 3, 0]])

    def loss(strengths):
        return np.sum(wins * np.log1p(np.exp(strengths[None, :] - strengths[:, None])))

    reference = minimize(loss, np.zeros(4), tol=1e-12).x
    assert fit_strengths(wins) == pytest.approx(reference - reference.mean(), abs=1e-5)


def test_over_85_percent_of_rating_intervals_cover_the_true_ratings_of_varied_judges():
    covered = total = 0
    for seed in range(6):
        result = rate_systems(judge(seed, participants=25, repetitions=1, spread=120.0), 0.95)
        assert result is not None
        shrunk = np.mean(list(TRUE_RATINGS.values()))
        for name, rating in result.ratings.items():
            factor = 0.88  # averaging over judges with a spread of 120 points shrinks differences (probit, 0.87 to 0.9)
            expected = shrunk + factor * (TRUE_RATINGS[name] - shrunk)
            covered += rating.interval[0] <= expected <= rating.interval[1]
            total += 1
    assert covered / total > 0.85


def test_elo_ratings_stay_finite_if_one_system_always_wins():
    choices = [PairChoice("a", "one", "other"), PairChoice("b", "one", "other")]
    result = rate_systems(choices, 0.95)
    assert result is not None
    assert not result.is_bounded
    assert 1000.0 < result.ratings["one"].points < 1400.0
    assert np.isnan(result.ratings["one"].interval).all(), "unanimous answers set no upper bound"
    alone = rate_systems(choices[:1], 0.95)
    assert alone is not None
    assert np.isnan(alone.ratings["one"].interval).all()
    assert rate_systems([], 0.95) is None
    apart = rate_systems([*choices, PairChoice("a", "x", "y")], 0.95)
    assert apart is not None
    assert not apart.is_connected
