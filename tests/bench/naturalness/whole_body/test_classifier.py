import numpy as np
import pytest

from kinesic.bench.naturalness.whole_body.classifier import (
    Sample,
    area_under_curve,
    assign_folds,
    score_logistic,
    score_neighbours,
    separate_samples,
    separate_unseen,
)

SCORERS = (score_logistic, score_neighbours)


def make_sample(generator, count, *, shift=0.0, performances=10, name="a"):
    """Return clips with normally distributed features and a shifted first feature."""
    features = generator.normal(size=(count, 3))
    features[:, 0] += shift
    return Sample(features, tuple(f"{name}{k % performances}" for k in range(count)))


def test_area_under_curve_counts_pairs_and_halves_ties():
    assert area_under_curve(np.array([2.0, 3.0]), np.array([1.0, 0.0])) == 1.0
    assert area_under_curve(np.array([0.0, 3.0]), np.array([1.0, 2.0])) == 0.5
    assert area_under_curve(np.array([1.0]), np.array([1.0, 0.0])) == 0.75


@pytest.mark.parametrize("scorer", SCORERS)
def test_classifier_cannot_separate_equal_distributions(scorer):
    generator = np.random.default_rng(1)
    result = separate_samples(make_sample(generator, 300), make_sample(generator, 300, name="b"), scorer)
    assert result.auc == pytest.approx(0.5, abs=0.08)
    assert result.accuracy == pytest.approx(0.5, abs=0.08)


@pytest.mark.parametrize("scorer", SCORERS)
def test_shift_of_one_feature_separates_the_classes_as_predicted_by_theory(scorer):
    generator = np.random.default_rng(2)
    ours, others = make_sample(generator, 400, shift=1.5), make_sample(generator, 400, name="b")
    result = separate_samples(ours, others, scorer)
    assert result.auc == pytest.approx(0.856, abs=0.06)  # normal distribution at 1.5 / sqrt(2)
    assert result.accuracy == pytest.approx(0.773, abs=0.06)  # normal distribution at 0.75


@pytest.mark.parametrize("scorer", SCORERS)
def test_cross_validation_by_performance_prevents_leakage_of_performance_features(scorer):
    generator = np.random.default_rng(3)

    def marked(name):
        marks = np.repeat(generator.normal(size=(12, 8)), 10, axis=0)
        return Sample(
            marks + 0.01 * generator.normal(size=marks.shape), tuple(f"{name}{k // 10}" for k in range(len(marks)))
        )

    ours, others = marked("a"), marked("b")
    leaky = [Sample(sample.features, tuple(map(str, range(len(sample))))) for sample in (ours, others)]
    assert separate_samples(*leaky, score_neighbours).auc > 0.95
    assert separate_samples(ours, others, scorer).auc < 0.75


def test_clips_of_one_performance_are_in_the_same_cross_validation_fold():
    performances = ["a"] * 5 + ["b"] * 3 + ["c", "d", "e", "f", "g"]
    folds = assign_folds(performances)
    assert len({tuple(set(folds[[k for k, p in enumerate(performances) if p == name]])) for name in "abcdefg"}) == 5
    assert all(len(set(folds[[k for k, p in enumerate(performances) if p == name]])) == 1 for name in "abcdefg")
    with pytest.raises(ValueError, match="two performances"):
        assign_folds(["a", "a"])


def test_classifier_is_not_trained_with_unseen_clips():
    generator = np.random.default_rng(4)
    ours, seen = make_sample(generator, 100, shift=6.0), make_sample(generator, 100, name="b")
    unseen = make_sample(generator, 100, shift=12.0, name="c")  # on the other side of ours
    assert separate_samples(ours, unseen).auc > 0.95
    assert separate_unseen(ours, seen, unseen).auc < 0.05


def test_classifier_ignores_constant_features():
    ours = Sample(np.column_stack([np.ones(20), np.arange(20.0)]), tuple(map(str, range(20))))
    others = Sample(np.column_stack([np.ones(20), np.arange(20.0) + 100]), tuple(map(str, range(20))))
    assert separate_samples(ours, others).auc == 1.0
