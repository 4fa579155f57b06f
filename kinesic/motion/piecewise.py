"""Polynomials one after the other, over time: given by their coefficients, or by the states between them.

They give the bits of SciPy's `PPoly`, without the third of a second of processor time that it takes to import.
"""

from dataclasses import dataclass
from functools import cached_property
from math import perm

import numpy as np

from kinesic.body.arrays import Floats

TIMES_PER_EVALUATION = 1024  # times that are looked at together: their coefficients stay in the cache


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


@dataclass(frozen=True, eq=False)
class QuinticSpline:
    """Some curves of quintics that meet up to the acceleration: half as many numbers as their coefficients."""

    times: Floats  # (k + 1,) [s] where pieces begin, and the last one ends; increasing
    states: Floats  # (3, k + 1, h) angles, speeds and accelerations at these

    def derivatives(self, times: Floats, count: int) -> Floats:
        """Finds (count, m, h) values, speeds, accelerations and so on, so many of them, at (m,) times [s]."""
        found = np.empty((count, len(times), self.states.shape[2]))
        for begin in range(0, len(times), TIMES_PER_EVALUATION):
            part = times[begin : begin + TIMES_PER_EVALUATION]
            found[:, begin : begin + TIMES_PER_EVALUATION] = self._around(part).derivatives(part, count)
        return found

    def _around(self, times: Floats) -> PiecewisePolynomial:
        """The pieces in which some times are, or all of a short curve."""
        if len(self.times) <= TIMES_PER_EVALUATION:
            return self._whole
        first, last = self.times[1:-1].searchsorted([times.min(), times.max()], side="right").tolist()
        return self._between(first, last)

    @cached_property
    def _whole(self) -> PiecewisePolynomial:
        return self._between(0, len(self.times) - 2)

    def _between(self, first: int, last: int) -> PiecewisePolynomial:
        """From one piece to another one."""
        times, states = self.times[first : last + 2], self.states[:, first : last + 2]
        return PiecewisePolynomial(times, _quintics(times[1:] - times[:-1], *states))


def _quintics(steps: Floats, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
    """(6, k, h) coefficients, highest power first, between (k + 1, h) angles, speeds and accelerations."""
    h, v0, a0 = steps[:, None], speeds[:-1], accelerations[:-1]
    d = angles[1:] - angles[:-1] - v0 * h - a0 * h**2 / 2
    v = (speeds[1:] - v0 - a0 * h) * h
    a = (accelerations[1:] - a0) * h**2
    high = [(6 * d - 3 * v + a / 2) / h**5, (-15 * d + 7 * v - a) / h**4, (10 * d - 4 * v + a / 2) / h**3]
    return np.stack([*high, a0 / 2, v0, angles[:-1]])
