"""Finds the least shift of key times that physics allows: a nonlinear program, the offline reference of `condition`.

Free are all key times and, per hinge, a motion whose jerk is constant on equal pieces of each gap, so that pieces
stretch with their gaps. It obeys the same limits, gaps, bonds and lead-in and minimises the same strain. It takes
seconds; only tests and benches use it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

import casadi
import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.condition import Conditioned
from kinesic.motion.infeasibility import measure_shortage
from kinesic.motion.key_time_lp import BROKEN, LATENESS, strain
from kinesic.motion.keys import Keys
from kinesic.motion.segments import LEAST_SWING, SWING, segments
from kinesic.motion.trajectory import STEP

PIECE = 0.02  # [s] about the length of a piece
FEWEST, MOST = 8, 24  # pieces of a gap
TOLERANCE = 2e-3  # on limits, on a dense grid
DENSE = np.linspace(0.0, 1.0, 17)  # of a piece
SHORT = 1e-4  # share of the time that a hinge outside the program may lack
OPTIONS: dict[str, int | float | str] = {
    "ipopt.max_iter": 500,
    "ipopt.tol": 1e-6,
    "ipopt.mu_init": 1e-2,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
}


@dataclass(frozen=True, eq=False)
class BestTimes:
    """The best times that were found."""

    times: Floats  # (m,) [s] block time of the keys
    strain: float  # what `condition` makes least, too
    excess: float  # largest share of a limit on a dense grid


def best_times(keys: Keys, motion: Conditioned, limits: Limits, lead_in: float) -> BestTimes | None:
    """Finds the least strain, from a motion and from the asked times; None when none is found.

    Only hinges that bind take part: those that met a limit, and then any that cannot pass the times found without it.

    Args:
        keys: what was asked.
        motion: of `condition` for the same keys.
        limits: of all hinges.
        lead_in: [s] by which the first key may come earlier.
    """
    found = []
    for begin in (motion.planned, _spread(keys)):
        hinges = {met.hinge for met in motion.bottlenecks.values()}
        best = _solved(keys, hinges, motion, limits, lead_in, begin)
        while best is not None and (more := _short(best.times, keys, limits) - hinges):
            hinges |= more
            best = _solved(keys, hinges, motion, limits, lead_in, begin)
        found.append(best)
    return min((best for best in found if best is not None), key=lambda best: best.strain, default=None)


def _short(times: Floats, keys: Keys, limits: Limits) -> set[int]:
    """Hinges that cannot pass their keys at some times."""
    moving = [segment for segment in segments(times, keys, STEP) if not segment.still]
    found = [(segment.hinge, measure_shortage(segment, limits)) for segment in moving]
    return {hinge for hinge, lack in found if lack is None or lack.amount > SHORT}


def _spread(keys: Keys) -> Floats:
    """The asked times, each at least a little after the one before."""
    times = np.array(keys.asked)
    for before, after in pairwise(np.argsort(keys.asked, kind="stable")):
        times[after] = max(times[after], times[before] + 2 * PIECE)
    return times


@dataclass(eq=False)
class _Program:
    symbols: list[casadi.SX] = field(default_factory=list)
    values: list[tuple[Floats, Floats, Floats]] = field(default_factory=list)  # begin, lower, upper
    rows: list[casadi.SX] = field(default_factory=list)
    bounds: list[tuple[Floats, Floats]] = field(default_factory=list)

    def variable(self, begin: Floats, lower: ArrayLike, upper: ArrayLike) -> casadi.SX:
        """A vector, from where it begins and its bounds."""
        symbol = casadi.SX.sym(f"x{len(self.symbols)}", len(begin))
        self.symbols.append(symbol)
        self.values.append((begin, _wide(lower, begin), _wide(upper, begin)))
        return symbol

    def require(self, rows: casadi.SX, lower: ArrayLike, upper: ArrayLike) -> None:
        """Rows between bounds."""
        count = np.empty(rows.numel())
        self.rows.append(rows)
        self.bounds.append((_wide(lower, count), _wide(upper, count)))

    def solved(self, cost: casadi.SX) -> list[Floats] | None:
        """The values of all variables; None without success."""
        problem = {"x": casadi.vertcat(*self.symbols), "f": cost, "g": casadi.vertcat(*self.rows)}
        solver = casadi.nlpsol("optimum", "ipopt", problem, {"print_time": False, **OPTIONS})
        begin, least, most = (np.concatenate(parts) for parts in zip(*self.values, strict=True))
        lower, upper = (np.concatenate(parts) for parts in zip(*self.bounds, strict=True))
        told = solver(x0=begin, lbx=least, ubx=most, lbg=lower, ubg=upper)
        if not solver.stats()["success"]:
            return None
        ends = np.cumsum([len(begin) for begin, _, _ in self.values])
        return np.split(np.array(told["x"]).ravel(), ends[:-1])


def _wide(bound: ArrayLike, like: Floats) -> Floats:
    return np.array(np.broadcast_to(bound, like.shape), dtype=np.float64)


def _solved(
    keys: Keys, hinges: Iterable[int], motion: Conditioned, limits: Limits, lead_in: float, begin: Floats
) -> BestTimes | None:
    program, moved = _Program(), begin - keys.asked
    times = program.variable(begin, keys.asked[0] - lead_in, np.inf)
    late = program.variable(np.maximum(moved, 0.0), 0.0, np.inf)
    early = program.variable(np.maximum(-moved, 0.0), 0.0, np.inf)
    loose = program.variable(np.zeros(len(keys.bonds)), 0.0, np.inf)
    program.require(times - keys.asked - late + early, 0.0, 0.0)
    for (i, j), gap in keys.gaps.items():
        program.require(times[j] - times[i], gap, np.inf)
    for row, ((i, j), least) in enumerate(keys.bonds.items()):
        program.require(times[j] - times[i] + loose[row], least, np.inf)
    ways = [_Way.of(keys, hinge, motion, limits) for hinge in hinges]
    for way in ways:
        way.join(program, times, motion, begin)
    cost = casadi.dot(keys.weights, LATENESS * late + early) + BROKEN * casadi.sum1(loose)
    values = program.solved(cost)
    if values is None:
        return None
    found, states = values[0], values[4:]
    excess = max(way.excess(found, states[4 * k : 4 * k + 4]) for k, way in enumerate(ways))
    return BestTimes(sealed(found), strain(keys, found), excess) if excess <= 1.0 + TOLERANCE else None


@dataclass(frozen=True, eq=False)
class _Way:
    """The pieces of one hinge."""

    hinge: int
    limits: Limits
    own: NDArray[np.intp]  # (m,) its keys
    angles: Floats  # (m,) [rad]
    counts: NDArray[np.intp]  # (m - 1,) pieces of each gap

    @classmethod
    def of(cls, keys: Keys, hinge: int, motion: Conditioned, limits: Limits) -> "_Way":
        """As many pieces as the gaps of a motion are long."""
        own = np.array(keys.own[hinge])
        counts = np.clip(np.ceil(np.diff(motion.planned[own]) / PIECE), FEWEST, MOST).astype(np.intp)
        return cls(hinge, limits, own, keys.angles[own, hinge], counts)

    def join(self, program: _Program, times: casadi.SX, motion: Conditioned, begin: Floats) -> None:
        """Adds angles, speeds, accelerations and jerks, the last three as shares of their limits, and their rows."""
        top = self._tops
        passed = np.concatenate([[0], np.cumsum(self.counts)])
        states, jerks = self._begin(motion, begin)
        least, most = self._corridor()
        lower, upper = np.full(passed[-1] + 1, np.inf), np.full(passed[-1] + 1, -np.inf)
        for side in (np.s_[:-1], np.s_[1:]):
            lower[side], upper[side] = np.minimum(lower[side], least), np.maximum(upper[side], most)
        lower[passed] = upper[passed] = states[0][passed] = self.angles
        rest = np.ones(passed[-1] + 1)
        rest[[0, -1]] = 0.0
        angle = program.variable(states[0], lower, upper)
        speed, bend = (
            program.variable(np.clip(state / limit, -rest, rest), -rest, rest)
            for state, limit in zip(states[1:], top, strict=False)
        )
        jerk = program.variable(np.clip(jerks / top[2], -1.0, 1.0), -1.0, 1.0)
        gaps = times[self.own[1:].tolist()] - times[self.own[:-1].tolist()]
        h = casadi.vertcat(*(casadi.repmat(gaps[k] / int(n), int(n), 1) for k, n in enumerate(self.counts)))
        q, v, a, j = angle[:-1], top[0] * speed[:-1], top[1] * bend[:-1], top[2] * jerk
        program.require((a + j * h) / top[1] - bend[1:], 0.0, 0.0)
        program.require((v + a * h + j * h**2 / 2) / top[0] - speed[1:], 0.0, 0.0)
        program.require(q + v * h + a * h**2 / 2 + j * h**3 / 6 - angle[1:], 0.0, 0.0)
        ends = angle[1:] - top[0] * speed[1:] * h / 3
        program.require(casadi.vertcat(q + v * h / 3, ends), np.tile(least, 2), np.tile(most, 2))
        inertial, viscous, duty = (
            row[self.hinge] for row in (self.limits.inertial, self.limits.viscous, self.limits.duty)
        )
        pull, rise = inertial * a + viscous * v, inertial * j + viscous * a
        end = inertial * top[1] * bend[1:] + viscous * top[0] * speed[1:]
        program.require(casadi.vertcat(pull, end[-1]) / duty, -1.0, 1.0)
        _between(program, v / top[0], speed[1:], a * h / top[0], j * h**2 / top[0])
        _between(program, pull / duty, end / duty, rise * h / duty, viscous * j * h**2 / duty)

    def _corridor(self) -> tuple[Floats, Floats]:
        """(p,) [rad] between which each piece lies: not far from the keys about it, beside a key those of both gaps."""
        limits, n = self.limits, self.hinge
        low, high = np.minimum(self.angles[:-1], self.angles[1:]), np.maximum(self.angles[:-1], self.angles[1:])
        swing = np.maximum(SWING * (high - low), LEAST_SWING)
        lower, upper = np.repeat(low - swing, self.counts), np.repeat(high + swing, self.counts)
        passed = np.cumsum(self.counts)[:-1]
        lower[passed] = lower[passed - 1] = np.minimum(lower[passed], lower[passed - 1])
        upper[passed] = upper[passed - 1] = np.maximum(upper[passed], upper[passed - 1])
        return np.maximum(lower, limits.lower[n]), np.minimum(upper, limits.upper[n])

    @property
    def _tops(self) -> tuple[float, float, float]:
        limits = self.limits
        n = self.hinge
        return float(limits.speed[n]), float(limits.acceleration[n]), float(limits.jerk[n])

    def _begin(self, motion: Conditioned, begin: Floats) -> tuple[list[Floats], Floats]:
        """Angles, speeds and accelerations between the pieces, and jerks: of a motion, as stretched as its gaps."""
        planned, first = motion.planned[self.own], begin[self.own]
        at = np.append(
            np.concatenate(
                [np.linspace(a, b, n, endpoint=False) for (a, b), n in zip(pairwise(planned), self.counts, strict=True)]
            ),
            planned[-1],
        )
        stretch = np.repeat(np.diff(first) / np.diff(planned), self.counts)
        stretch = np.append(stretch, stretch[-1])
        q, v, a = (values[:, self.hinge] for values in motion.trajectory.sample(at + motion.trajectory.zero))
        states = [q, v / stretch, a / stretch**2]
        jerks = np.diff(states[2]) / np.repeat(np.diff(first) / self.counts, self.counts)
        return states, jerks

    def excess(self, times: Floats, values: list[Floats]) -> float:
        """The largest share of a limit on a dense grid."""
        angle, speed, bend, jerk = values
        top, limits, n = self._tops, self.limits, self.hinge
        h = np.repeat(np.diff(times[self.own]) / self.counts, self.counts)[:, None]
        q, v, a, j = angle[:-1, None], top[0] * speed[:-1, None], top[1] * bend[:-1, None], top[2] * jerk[:, None]
        s = DENSE * h
        angles, speeds, bends = q + v * s + a * s**2 / 2 + j * s**3 / 6, v + a * s + j * s**2 / 2, a + j * s
        half, middle = (limits.upper[n] - limits.lower[n]) / 2, (limits.upper[n] + limits.lower[n]) / 2
        duty = limits.inertial[n] * bends + limits.viscous[n] * speeds
        shares = ((angles - middle) / half, speeds / top[0], bends / top[1], jerk, duty / limits.duty[n])
        return max(float(np.abs(share).max()) for share in shares)


def _between(program: _Program, begin: casadi.SX, end: casadi.SX, slope: casadi.SX, bend: casadi.SX) -> None:
    """Rows for the middle control points of both halves of each piece, and what is between them, within -1..1.

    Args:
        program: of the rows.
        begin: (p,) shares of a limit at the beginning of each piece, a parabola.
        end: (p,) at the end.
        slope: (p,) of the parabola at the beginning, times the length of the piece.
        bend: (p,) of the parabola, times the square of the length.
    """
    program.require(begin + slope / 4, -1.0, 1.0)
    program.require(end - (slope + bend) / 4, -1.0, 1.0)
    program.require((begin + end) / 2 - bend / 8, -1.0, 1.0)
