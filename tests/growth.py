"""Measurement of how run time grows with input size."""

from collections.abc import Callable
from math import inf, sqrt
from time import process_time
from typing import TypeVar

T = TypeVar("T")

MIN_MEASURED_TIME = 0.003  # [s] of processor time needed for a comparison
MAX_INPUT_SIZE = 2**19  # largest input size
MEASUREMENT_ROUNDS = 3  # measurements of the small input
MAX_ROUNDS = 6  # most measurements of the large input, until one is clearly linear
LINEAR_GROWTH_LIMIT = 3.4  # time ratio for doubled input: 2 if linear, more beyond a cache, 4 if quadratic
STRICT_GROWTH_LIMIT = 2.7  # time ratio for doubled input that is clearly linear


def growth(
    work: Callable[[T], object], make: Callable[[int], T], *, size: int = 256, most: int = MAX_INPUT_SIZE
) -> float:
    """Return the time ratio for doubled input, the minimum of several rounds.

    It is measured over two doublings, because a cache limit makes a single one look quadratic.

    Args:
        work: function to measure.
        make: creates its input of a given size.
        size: initial size; it grows until the run time is measurable.
        most: maximum size.
    """
    while (once := _seconds(work, make(size))) < MIN_MEASURED_TIME and size < most:
        size *= 2
    small, large = make(size), make(4 * size)
    times = 1 if once > MIN_MEASURED_TIME else 1 + int(MIN_MEASURED_TIME / max(once, MIN_MEASURED_TIME / 100))
    rounds = [once] if times == 1 else []
    rounds += [_seconds(work, small, times) for _ in range(MEASUREMENT_ROUNDS - len(rounds))]
    least = min(rounds)
    smallest = inf
    for _ in range(MAX_ROUNDS):
        smallest = min(smallest, sqrt(_seconds(work, large, times) / least))
        if smallest < STRICT_GROWTH_LIMIT:  # further rounds could only reduce it
            break
    return smallest


def _seconds(work: Callable[[T], object], given: T, times: int = 1) -> float:
    began = process_time()
    for _ in range(times):
        work(given)
    return process_time() - began
