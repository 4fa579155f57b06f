"""Statistical power of a study with a given number of answers."""

import math

MAX_PLANNED_ANSWERS = 1_000_000  # largest number of answers considered for a plan
DEFAULT_POWER = 0.8  # probability with which a planned study detects the effect
SIGNIFICANCE_LEVEL = 0.05  # largest p-value of a detected effect


def compute_power(rate: float, answers: int) -> float:
    """Return the probability of detecting that a rate differs from one half.

    The test is the exact two-sided binomial test at `SIGNIFICANCE_LEVEL`; answers count as independent.

    Args:
        rate: true rate, 0..1.
        answers: number of answers.
    """
    from scipy.stats import binom  # noqa: PLC0415 - slow import, only needed for answers

    least = int(binom.isf(SIGNIFICANCE_LEVEL / 2.0, answers, 0.5)) + 1  # fewest hits of a significant result
    return float(binom.sf(least - 1, answers, rate) + binom.cdf(answers - least, answers, rate))


def find_detectable_rate(answers: int, power: float = DEFAULT_POWER) -> float:
    """Return the smallest detectable rate above one half, NaN if none."""
    if answers < 1 or compute_power(1.0, answers) < power:
        return math.nan
    low, high = 0.5, 1.0
    while high - low > 1e-6:
        middle = (low + high) / 2.0
        low, high = (low, middle) if compute_power(middle, answers) >= power else (middle, high)
    return high


def find_needed_answers(rate: float, power: float = DEFAULT_POWER) -> int | None:
    """Return the number of answers needed to detect a rate.

    Returns:
        None for a rate of one half, and beyond `MAX_PLANNED_ANSWERS`.
    """
    low, high = 0, 8
    while compute_power(rate, high) < power:
        low, high = high, 2 * high
        if high > MAX_PLANNED_ANSWERS:
            return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if compute_power(rate, middle) >= power else (middle, high)
    while compute_power(rate, high + 1) < power or compute_power(rate, high + 2) < power:  # the power oscillates
        high += 1
    return high


def convert_to_points(rate: float) -> float:
    """Convert a preference rate in 0..1 to a rating difference [Elo points]."""
    return math.inf if rate >= 1.0 else 400.0 * math.log10(rate / (1.0 - rate))
