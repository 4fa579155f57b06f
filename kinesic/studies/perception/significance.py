"""Corrected p-values and effect sizes of two conditions (thesis 4.5).

SciPy is imported by the functions that need it, because it is slow to import.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan, nan
from statistics import fmean
from typing import TypeVar

SIGNIFICANCE_LEVEL = 0.05  # p-value below which two conditions differ significantly

Test = TypeVar("Test", bound=Hashable)


@dataclass(frozen=True)
class GroupTest:
    """Mann-Whitney test of two independent groups."""

    p: float  # two-sided; NaN if a group is empty
    delta: float  # Cliff's delta, -1..1: P(left > right) - P(left < right)


@dataclass(frozen=True)
class PairedTest:
    """Wilcoxon signed-rank test of one difference per participant."""

    participants: int  # number of participants with ratings under both conditions
    difference: float  # mean over participants; NaN without any
    p: float  # two-sided; NaN without participants
    correlation: float  # matched-pairs rank-biserial correlation, -1..1


def compare_groups(left: Sequence[float], right: Sequence[float]) -> GroupTest:
    """Test whether two groups have equal distributions."""
    from scipy.stats import mannwhitneyu  # noqa: PLC0415 - slow import, only needed for answers

    if not left or not right:
        return GroupTest(nan, nan)
    result = mannwhitneyu(left, right, alternative="two-sided")
    return GroupTest(float(result.pvalue), 2.0 * float(result.statistic) / (len(left) * len(right)) - 1.0)


def compare_pairs(differences: Sequence[float]) -> PairedTest:
    """Test whether differences within participants are symmetric about zero."""
    from scipy.stats import rankdata, wilcoxon  # noqa: PLC0415 - slow import, only needed for answers

    if not differences:
        return PairedTest(0, nan, nan, nan)
    changed = [difference for difference in differences if difference]
    if not changed:
        return PairedTest(len(differences), 0.0, 1.0, 0.0)
    ranks = rankdata([abs(difference) for difference in changed])
    signed = sum(rank if difference > 0 else -rank for rank, difference in zip(ranks, changed, strict=True))
    p = float(wilcoxon(changed, alternative="two-sided").pvalue)
    return PairedTest(len(differences), fmean(differences), p, float(signed / ranks.sum()))


def adjust_holm(p_values: Mapping[Test, float]) -> dict[Test, float]:
    """Return p-values adjusted for multiple tests (S. Holm, 1979).

    Tests without a p-value (NaN) do not count.
    """
    valid = sorted((p, k) for k, p in enumerate(p_values.values()) if not isnan(p))
    corrected, largest = [nan] * len(p_values), 0.0
    for place, (p, k) in enumerate(valid):
        largest = max(largest, min(1.0, (len(valid) - place) * p))
        corrected[k] = largest
    return dict(zip(p_values, corrected, strict=True))
