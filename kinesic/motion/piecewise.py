"""Piecewise polynomials of time.

Results equal those of SciPy's `PPoly` bit for bit, without the third of a second that its import takes.
"""

from dataclasses import dataclass
from functools import cached_property
from math import perm

import numpy as np

from kinesic.body.arrays import Floats

TIMES_PER_EVALUATION = 1024  # number of times evaluated at once, so that their coefficients stay in the cache


@dataclass(frozen=True, eq=False)
class PiecewisePolynomial:
    """Piecewise polynomial curves over common time intervals."""

    times: Floats  # (k + 1,) [s] where pieces begin, and the last one ends; increasing
    coefficients: Floats  # (p, k, h) of the powers of the time since a piece began, the highest first

    def at(self, times: Floats) -> Floats:
        """Return the values (m, h) at times (m,) [s]."""
        terms, since = self._terms(times)
        return _sum(terms, since, 0)

    def derivatives(self, times: Floats, count: int) -> list[Floats]:
        """Return values and derivatives, (m, h) each, at times (m,) [s]."""
        terms, since = self._terms(times)
        return [_sum(terms, since, order) for order in range(count)]

    def _terms(self, times: Floats) -> tuple[Floats, Floats]:
        """Return the polynomial coefficients that apply at times (m,) [s].

        Returns:
            (p, m, h) coefficients, lowest power first, and (m, 1) [s] times since the start of their intervals.
        """
        pieces = self.times[1:-1].searchsorted(times, side="right")
        return self.coefficients.take(pieces, axis=1)[::-1], (times - self.times[pieces])[:, None]


def _sum(terms: Floats, since: Floats, order: int) -> Floats:
    """Sum the terms of a derivative, lowest power first as in SciPy."""
    total: Floats = 0.0 + terms[order] * float(perm(order, order))
    power = since
    for k, term in enumerate(terms[order + 1 :], order + 1):
        raised = term * power
        total += raised * float(perm(k, order)) if order else raised
        power = power * since
    return total


@dataclass(frozen=True, eq=False)
class QuinticSpline:
    """Quintic curves defined by angle, velocity and acceleration at knots."""

    times: Floats  # (k + 1,) [s] where pieces begin, and the last one ends; increasing
    states: Floats  # (3, k + 1, h) angles, velocities and accelerations at these times

    def derivatives(self, times: Floats, count: int) -> Floats:
        """Return values and derivatives (count, m, h) at times (m,) [s]."""
        derivatives = np.empty((count, len(times), self.states.shape[2]))
        for begin in range(0, len(times), TIMES_PER_EVALUATION):
            part = times[begin : begin + TIMES_PER_EVALUATION]
            derivatives[:, begin : begin + TIMES_PER_EVALUATION] = self._around(part).derivatives(part, count)
        return derivatives

    def _around(self, times: Floats) -> PiecewisePolynomial:
        """Return the polynomials of the intervals around the given times."""
        if len(self.times) <= TIMES_PER_EVALUATION:
            return self._whole
        first, last = self.times[1:-1].searchsorted([times.min(), times.max()], side="right").tolist()
        return self._between(first, last)

    @cached_property
    def _whole(self) -> PiecewisePolynomial:
        return self._between(0, len(self.times) - 2)

    def _between(self, first: int, last: int) -> PiecewisePolynomial:
        """Return the polynomials of a range of intervals."""
        times, states = self.times[first : last + 2], self.states[:, first : last + 2]
        return PiecewisePolynomial(times, _quintics(times[1:] - times[:-1], *states))


def _quintics(steps: Floats, angles: Floats, velocities: Floats, accelerations: Floats) -> Floats:
    """Return quintic coefficients (6, k, n), highest power first, between knots.

    The knots have given angles, velocities and accelerations (k + 1, n).
    """
    h, v0, a0 = steps[:, None], velocities[:-1], accelerations[:-1]
    d = angles[1:] - angles[:-1] - v0 * h - a0 * h**2 / 2
    v = (velocities[1:] - v0 - a0 * h) * h
    a = (accelerations[1:] - a0) * h**2
    high = [(6 * d - 3 * v + a / 2) / h**5, (-15 * d + 7 * v - a) / h**4, (10 * d - 4 * v + a / 2) / h**3]
    return np.stack([*high, a0 / 2, v0, angles[:-1]])
