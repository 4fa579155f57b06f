"""How the time of some work grows with what it is given."""

from collections.abc import Callable
from math import inf, sqrt
from time import process_time
from typing import TypeVar

T = TypeVar("T")

ENOUGH = 0.01  # [s] of processor time that can be compared
MOST = 2**19  # of a size
ROUNDS = 3
STRAIGHT = 3.4  # times as long for twice as much: a straight line has 2, more where it leaves a cache; a square 4
PLAIN = 2.7  # plainly a straight line


def growth(work: Callable[[T], object], make: Callable[[int], T], *, size: int = 256, most: int = MOST) -> float:
    """How many times longer the work takes for twice as much, the quickest of some rounds.

    Measured over two doublings: what no longer fits a cache makes one of them look like a square.

    Args:
        work: that is measured.
        make: what it is given, by its size.
        size: to begin with; it grows until the work takes long enough to be compared.
        most: to which it grows.
    """
    while (once := _seconds(work, make(size))) < ENOUGH and size < most:
        size *= 2
    small, large = make(size), make(4 * size)
    times = 1 if once > ENOUGH else 1 + int(ENOUGH / max(once, ENOUGH / 100))
    rounds = [once] if times == 1 else []
    rounds += [_seconds(work, small, times) for _ in range(ROUNDS - len(rounds))]
    least = min(rounds)
    found = inf
    for _ in range(ROUNDS):
        found = min(found, sqrt(_seconds(work, large, times) / least))
        if found < PLAIN:  # further rounds could only find less
            break
    return found


def _seconds(work: Callable[[T], object], given: T, times: int = 1) -> float:
    began = process_time()
    for _ in range(times):
        work(given)
    return process_time() - began
