"""Holm's correction and effect sizes, compared with their definitions."""

from math import isnan, nan

import numpy as np
import pytest

from kinesic.studies.perception.significance import adjust_holm, compare_groups, compare_pairs


def test_holm_correction_multiplies_by_the_number_of_remaining_tests():
    corrected = adjust_holm({"a": 0.01, "b": 0.04, "c": 0.03, "none": nan, "d": 0.005})
    assert corrected["d"] == pytest.approx(4 * 0.005)
    assert corrected["a"] == pytest.approx(3 * 0.01)
    assert corrected["c"] == pytest.approx(2 * 0.03)
    assert corrected["b"] == pytest.approx(2 * 0.03), "p-values keep their order"
    assert isnan(corrected["none"])
    assert list(corrected) == ["a", "b", "c", "none", "d"]
    assert adjust_holm({"a": 0.6, "b": 0.7}) == {"a": 1.0, "b": 1.0}


def test_cliffs_delta_is_the_difference_of_both_probabilities():
    random = np.random.default_rng(4)
    left, right = random.integers(1, 6, 31).tolist(), random.integers(2, 6, 17).tolist()
    expected = np.mean(np.sign(np.subtract.outer(left, right)))
    assert compare_groups(left, right).delta == pytest.approx(expected)
    assert compare_groups(right, left).delta == pytest.approx(-expected)
    assert compare_groups([5, 5], [1, 1]).delta == 1.0
    assert isnan(compare_groups([], [1]).p)


def test_rank_biserial_correlation_weighs_pairs_by_rank():
    result = compare_pairs([1.0, 2.0, -3.0, 0.0, 4.0])
    assert result.participants == 5
    assert result.difference == pytest.approx(0.8)
    assert result.correlation == pytest.approx((1 + 2 - 3 + 4) / 10)
    assert compare_pairs([2.0, 2.0, 1.0]).correlation == 1.0


def test_equal_ratings_of_two_conditions_give_no_difference_and_a_p_value_of_one():
    result = compare_pairs([0.0, 0.0])
    assert (result.participants, result.difference, result.p, result.correlation) == (2, 0.0, 1.0, 0.0)
    assert isnan(compare_pairs([]).p)


def test_constant_rating_difference_of_many_participants_is_significant():
    assert compare_pairs([1.0] * 11).p < 0.001
    assert compare_pairs([1.0, -1.0] * 3).p > 0.9
