"""Polynomials one after the other, over time.

They give the bits of SciPy's `PPoly`, without the third of a second of processor time that it takes to import.
"""

from dataclasses import dataclass
from math import perm

from kinesic.body.arrays import Floats


@dataclass(frozen=True, eq=False)
class PiecewisePolynomial:
    """Some curves over the same pieces of time; before the first and after the last piece they go on as in these."""

    times: Floats  # (k + 1,) [s] where pieces begin, and the last one ends; increasing
    coefficients: Floats  # (p, k, h) of the powers of the time since a piece began, the highest first

    def at(self, times: Floats) -> Floats:
        """(m, h) values at (m,) times [s]."""
        terms, since = self._terms(times)
        return _sum(terms, since, 0)

    def derivatives(self, times: Floats, count: int) -> list[Floats]:
        """Finds (m, h) values, speeds, accelerations and so on, so many of them, at (m,) times [s]."""
        terms, since = self._terms(times)
        return [_sum(terms, since, order) for order in range(count)]

    def _terms(self, times: Floats) -> tuple[Floats, Floats]:
        """(p, m, h) coefficients at (m,) times, from the constant on, and (m, 1) [s] since their pieces began."""
        pieces = self.times[1:-1].searchsorted(times, side="right")
        return self.coefficients.take(pieces, axis=1)[::-1], (times - self.times[pieces])[:, None]


def _sum(terms: Floats, since: Floats, order: int) -> Floats:
    """Adds the terms of a derivative, the lowest power first, as `PPoly` does."""
    found: Floats = 0.0 + terms[order] * float(perm(order, order))
    power = since
    for k, term in enumerate(terms[order + 1 :], order + 1):
        raised = term * power
        found += raised * float(perm(k, order)) if order else raised
        power = power * since
    return found
