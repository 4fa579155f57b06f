"""Power of a study, compared with simulated answers and published sample sizes."""

import numpy as np
import pytest
from scipy.stats import binomtest

from kinesic.studies.gesture_perception.power import (
    compute_power,
    convert_to_points,
    find_detectable_rate,
    find_needed_answers,
)


@pytest.mark.parametrize(("rate", "answers"), [(0.6, 150), (0.737, 40), (0.5, 200)])
def test_statistical_power_equals_the_fraction_of_significant_simulated_studies(rate: float, answers: int):
    hits = np.random.default_rng(1).binomial(answers, rate, 20_000)
    significant = np.array([binomtest(k, answers).pvalue <= 0.05 for k in range(answers + 1)])
    assert compute_power(rate, answers) == pytest.approx(significant[hits].mean(), abs=0.01)


def test_detectable_recognition_rate_and_needed_answers_are_inverse_functions():
    rate = find_detectable_rate(160)
    assert compute_power(rate, 160) == pytest.approx(0.8, abs=1e-3)
    assert find_needed_answers(rate + 1e-4) <= 175
    assert find_needed_answers(0.6) == pytest.approx(205, abs=8)  # normal approximations: 194, 204 with continuity
    assert find_needed_answers(0.5) is None
    assert np.isnan(find_detectable_rate(4))
    assert convert_to_points(0.76) == pytest.approx(200.0, abs=1.0)
