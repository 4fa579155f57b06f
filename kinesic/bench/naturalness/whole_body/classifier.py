"""Classifiers of two groups of clips, with one performance per validation fold."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit

from kinesic.body.arrays import Flags, Floats, Indices

RIDGE_WEIGHT = 1.0  # squared weights x this / (2 x training clips) is added to the class-balanced mean loss
NEIGHBOUR_COUNT = 9  # number of nearest clips of each class whose mean distance is compared
MAX_ITERATIONS = 200  # largest number of optimizer steps of the logistic regression
MAX_FOLDS = 5  # largest number of folds of the cross-validation


@dataclass(frozen=True, eq=False)
class Sample:
    """Feature vectors of clips, and the performance of each clip."""

    features: Floats  # (n, k) features of each clip
    performances: tuple[str, ...]  # performance of each clip; clips of one performance stay in one fold

    def __len__(self) -> int:
        return len(self.features)


@dataclass(frozen=True)
class Separation:
    """Accuracy and AUC of a classifier of two groups of clips."""

    auc: float  # area under the curve, 0.5 (chance) to 1
    accuracy: float  # mean of both groups' fractions of right decisions


Scorer = Callable[[Floats, Flags, Floats], Floats]  # training features, their labels, test features -> test scores


def separate_samples(ours: Sample, others: Sample, scorer: "Scorer | None" = None) -> Separation:
    """Return cross-validated AUC and accuracy of a classifier of two samples.

    Scores of a fold come from a classifier that saw no performance of this fold. AUC and accuracy are means over folds.

    Args:
        ours: clips labelled as positive.
        others: clips labelled as negative.
        scorer: classifier, by default logistic regression.
    """
    trials = [
        _Trial(ours.features[~first], others.features[~second], ours.features[first], others.features[second])
        for first, second in fold_pairs(ours.performances, others.performances)
    ]
    return _average(trials, scorer or score_logistic)


def separate_unseen(ours: Sample, seen: Sample, unseen: Sample, scorer: "Scorer | None" = None) -> Separation:
    """Measure how well a classifier separates our clips from unseen clips.

    Args:
        ours: clips labelled as positive, cross-validated by performance.
        seen: clips labelled as negative, for training.
        unseen: clips labelled as negative, for testing.
        scorer: classifier, by default logistic regression.
    """
    folds = assign_folds(ours.performances)
    trials = [
        _Trial(ours.features[folds != fold], seen.features, ours.features[folds == fold], unseen.features)
        for fold in range(int(folds.max()) + 1)
    ]
    return _average(trials, scorer or score_logistic)


@dataclass(frozen=True, eq=False)
class _Trial:
    """Features of one fold: training and test clips of both classes."""

    train_ours: Floats
    train_others: Floats
    test_ours: Floats
    test_others: Floats


def _average(trials: Sequence[_Trial], score: Scorer) -> Separation:
    """Return mean AUC and accuracy over folds, weighted by test clip pairs."""
    aucs, accuracies, weights = [], [], []
    for trial in trials:
        train = np.concatenate([trial.train_ours, trial.train_others])
        count = len(trial.test_ours)
        labels = np.arange(len(train)) < len(trial.train_ours)
        scores = score(train, labels, np.concatenate([trial.test_ours, trial.test_others]))
        aucs.append(area_under_curve(scores[:count], scores[count:]))
        accuracies.append((float((scores[:count] > 0.0).mean()) + float((scores[count:] <= 0.0).mean())) / 2)
        weights.append(count * len(trial.test_others))
    return Separation(float(np.average(aucs, weights=weights)), float(np.average(accuracies, weights=weights)))


def fold_pairs(ours: Sequence[str], others: Sequence[str]) -> Iterator[tuple[Flags, Flags]]:
    """Yield masks of the test clips of both samples, fold by fold."""
    first, second = assign_folds(ours), assign_folds(others)
    count = max(int(first.max()), int(second.max())) + 1
    for fold in range(count):
        yield first == fold % (int(first.max()) + 1), second == fold % (int(second.max()) + 1)


def assign_folds(performances: Sequence[str]) -> Indices:
    """Assign each clip to a fold (n,), without dividing any performance.

    The largest performances are assigned first, each to the smallest fold.

    Raises:
        ValueError: all clips belong to one performance.
    """
    names, members, counts = np.unique(list(performances), return_inverse=True, return_counts=True)
    if len(names) < 2:
        raise ValueError("cross-validation needs two performances or more")
    sizes = np.zeros(min(MAX_FOLDS, len(names)), dtype=np.intp)
    folds = np.zeros(len(names), dtype=np.intp)
    for k in np.argsort(-counts, kind="stable").tolist():
        folds[k] = int(sizes.argmin())
        sizes[folds[k]] += counts[k]
    return folds[members]


def area_under_curve(ours: Floats, others: Floats) -> float:
    """Return the probability that a score in `ours` exceeds one in `others`.

    Equal scores count half.
    """
    from scipy.stats import rankdata  # noqa: PLC0415 - slow import, rarely needed

    ranks = rankdata(np.concatenate([ours, others]))
    wins = float(ranks[: len(ours)].sum()) - len(ours) * (len(ours) + 1) / 2
    return wins / (len(ours) * len(others))


def score_logistic(train: Floats, labels: Flags, test: Floats) -> Floats:
    """Score clips by logistic regression with balanced classes.

    A positive score (n,) decides for the class labelled True.
    """
    train, test = _standardise(train, test)
    signs = np.where(labels, 1.0, -1.0)
    balance = np.where(labels, 0.5 / labels.sum(), 0.5 / (~labels).sum())
    columns = np.column_stack([train, np.ones(len(train))])
    ridge = RIDGE_WEIGHT / len(train) * np.append(np.ones(train.shape[1]), 0.0)

    def loss(weights: Floats) -> tuple[float, Floats]:
        margins = signs * (columns @ weights)
        gradient = columns.T @ (-balance * signs * expit(-margins)) + ridge * weights
        return float(balance @ np.logaddexp(0.0, -margins) + ridge @ weights**2 / 2), gradient

    weights = minimize(
        loss, np.zeros(columns.shape[1]), jac=True, method="L-BFGS-B", options={"maxiter": MAX_ITERATIONS}
    ).x
    scores: Floats = np.column_stack([test, np.ones(len(test))]) @ weights
    return scores


def score_neighbours(train: Floats, labels: Flags, test: Floats) -> Floats:
    """Score clips by the distance of their nearest neighbours in each class.

    A positive score (n,) decides for the class labelled True.
    """
    train, test = _standardise(train, test)
    distances = np.linalg.norm(test[:, None] - train[None], axis=-1)

    def mean_distance(members: Flags) -> Floats:
        count = min(NEIGHBOUR_COUNT, int(members.sum()))
        nearest: Floats = np.sort(distances[:, members], axis=1)[:, :count].mean(axis=1)
        return nearest

    scores: Floats = mean_distance(~labels) - mean_distance(labels)
    return scores


def _standardise(train: Floats, test: Floats) -> tuple[Floats, Floats]:
    mean, spread = train.mean(axis=0), train.std(axis=0)
    spread = np.where(spread > 0.0, spread, 1.0)
    return (train - mean) / spread, (test - mean) / spread
