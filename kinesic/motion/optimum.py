"""Optimal key times by nonlinear programming, as offline reference.

Variables are all key times and, per hinge, a motion with constant jerk on equal intervals of each gap, which stretch
with their gaps. It obeys the same limits, gaps, bonds and lead-in and minimises the same shift cost. It takes
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
from kinesic.motion.infeasibility import measure_time_deficit
from kinesic.motion.key_time_lp import BROKEN_BOND_WEIGHT, LATENESS_WEIGHT, shift_cost
from kinesic.motion.keys import Keys
from kinesic.motion.segments import MIN_SWING, SWING_FRACTION, segments
from kinesic.motion.trajectory import KNOT_INTERVAL

TARGET_INTERVAL = 0.02  # [s] approximate length of an interval with constant jerk
MIN_INTERVALS = 8  # smallest number of constant-jerk intervals between two keys
MAX_INTERVALS = 24  # largest number of constant-jerk intervals between two keys
LIMIT_TOLERANCE = 2e-3  # relative violation of limits allowed on a dense grid
DENSE_PARAMETERS = np.linspace(0.0, 1.0, 17)  # normalised sample times within an interval
DEFICIT_TOLERANCE = 1e-4  # [ln(time ratio)] deficit allowed for hinges outside the program
SOLVER_OPTIONS: dict[str, int | float | str] = {  # options of IPOPT
    "ipopt.max_iter": 500,
    "ipopt.tol": 1e-6,
    "ipopt.mu_init": 1e-2,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
}


@dataclass(frozen=True, eq=False)
class BestTimes:
    """Optimal key times with their cost and their largest limit ratio."""

    times: Floats  # (m,) [s] block time of the keys
    shift_cost: float  # the cost that `condition` minimises
    excess: float  # largest limit ratio on a dense grid


def best_times(keys: Keys, motion: Conditioned, limits: Limits, lead_in: float) -> BestTimes | None:
    """Return key times of least cost, or None if IPOPT fails.

    Only hinges with a binding limit take part: those with a bottleneck, then any that cannot pass the resulting times.

    Args:
        keys: at their requested times.
        motion: of `condition` for the same keys.
        limits: of all hinges.
        lead_in: [s] by which the first key may come earlier.
    """
    candidates = []
    for begin in (motion.planned, _separate_requested_times(keys)):
        hinges = {bottleneck.hinge for bottleneck in motion.bottlenecks.values()}
        best = _solve(keys, hinges, motion, limits, lead_in, begin)
        while best is not None and (infeasible := _find_infeasible(best.times, keys, limits) - hinges):
            hinges |= infeasible
            best = _solve(keys, hinges, motion, limits, lead_in, begin)
        candidates.append(best)
    return min((best for best in candidates if best is not None), key=lambda best: best.shift_cost, default=None)


def _find_infeasible(times: Floats, keys: Keys, limits: Limits) -> set[int]:
    """Return hinges with too little time between their keys."""
    moving = [segment for segment in segments(times, keys, KNOT_INTERVAL) if not segment.is_still]
    deficits = [(segment.hinge, measure_time_deficit(segment, limits)) for segment in moving]
    return {hinge for hinge, deficit in deficits if deficit is None or deficit.amount > DEFICIT_TOLERANCE}


def _separate_requested_times(keys: Keys) -> Floats:
    """Return the requested times [s], delayed to keep a minimum gap."""
    times = np.array(keys.requested_times)
    for before, after in pairwise(np.argsort(keys.requested_times, kind="stable")):
        times[after] = max(times[after], times[before] + 2 * TARGET_INTERVAL)
    return times


@dataclass(eq=False)
class _Program:
    symbols: list[casadi.SX] = field(default_factory=list)
    values: list[tuple[Floats, Floats, Floats]] = field(default_factory=list)  # start, lower, upper values
    rows: list[casadi.SX] = field(default_factory=list)
    bounds: list[tuple[Floats, Floats]] = field(default_factory=list)

    def variable(self, begin: Floats, lower: ArrayLike, upper: ArrayLike) -> casadi.SX:
        """Add optimisation variables with start values and bounds."""
        symbol = casadi.SX.sym(f"x{len(self.symbols)}", len(begin))
        self.symbols.append(symbol)
        self.values.append((begin, _broadcast(lower, begin), _broadcast(upper, begin)))
        return symbol

    def require(self, rows: casadi.SX, lower: ArrayLike, upper: ArrayLike) -> None:
        """Add constraints with lower and upper bounds."""
        count = np.empty(rows.numel())
        self.rows.append(rows)
        self.bounds.append((_broadcast(lower, count), _broadcast(upper, count)))

    def solve(self, cost: casadi.SX) -> list[Floats] | None:
        """Return the program's optimal variables, or None if IPOPT fails."""
        problem = {"x": casadi.vertcat(*self.symbols), "f": cost, "g": casadi.vertcat(*self.rows)}
        solver = casadi.nlpsol("optimum", "ipopt", problem, {"print_time": False, **SOLVER_OPTIONS})
        begin, smallest, largest = (np.concatenate(parts) for parts in zip(*self.values, strict=True))
        lower, upper = (np.concatenate(parts) for parts in zip(*self.bounds, strict=True))
        result = solver(x0=begin, lbx=smallest, ubx=largest, lbg=lower, ubg=upper)
        if not solver.stats()["success"]:
            return None
        ends = np.cumsum([len(begin) for begin, _, _ in self.values])
        return np.split(np.array(result["x"]).ravel(), ends[:-1])


def _broadcast(bound: ArrayLike, like: Floats) -> Floats:
    return np.array(np.broadcast_to(bound, like.shape), dtype=np.float64)


def _solve(
    keys: Keys, hinges: Iterable[int], motion: Conditioned, limits: Limits, lead_in: float, begin: Floats
) -> BestTimes | None:
    program, shifts = _Program(), begin - keys.requested_times
    times = program.variable(begin, keys.requested_times[0] - lead_in, np.inf)
    late = program.variable(np.maximum(shifts, 0.0), 0.0, np.inf)
    early = program.variable(np.maximum(-shifts, 0.0), 0.0, np.inf)
    bond_violations = program.variable(np.zeros(len(keys.bonds)), 0.0, np.inf)
    program.require(times - keys.requested_times - late + early, 0.0, 0.0)
    for (i, j), gap in keys.gaps.items():
        program.require(times[j] - times[i], gap, np.inf)
    for row, ((i, j), least) in enumerate(keys.bonds.items()):
        program.require(times[j] - times[i] + bond_violations[row], least, np.inf)
    hinge_motions = [_HingeMotion.of(keys, hinge, motion, limits) for hinge in hinges]
    for hinge_motion in hinge_motions:
        hinge_motion.join(program, times, motion, begin)
    cost = casadi.dot(keys.weights, LATENESS_WEIGHT * late + early) + BROKEN_BOND_WEIGHT * casadi.sum1(bond_violations)
    values = program.solve(cost)
    if values is None:
        return None
    optimum, states = values[0], values[4:]
    ratios = (part.excess(optimum, states[4 * k : 4 * k + 4]) for k, part in enumerate(hinge_motions))
    excess = max(ratios, default=0.0)
    return BestTimes(sealed(optimum), shift_cost(keys, optimum), excess) if excess <= 1.0 + LIMIT_TOLERANCE else None


@dataclass(frozen=True, eq=False)
class _HingeMotion:
    """Discretised motion of one hinge in the nonlinear program."""

    hinge: int
    limits: Limits
    rows: NDArray[np.intp]  # (m,) exact keys
    angles: Floats  # (m,) [rad]
    counts: NDArray[np.intp]  # (m - 1,) knot intervals of each gap

    @classmethod
    def of(cls, keys: Keys, hinge: int, motion: Conditioned, limits: Limits) -> "_HingeMotion":
        """Create a hinge's motion, with more intervals between keys farther apart."""
        rows = np.array(keys.exact_rows[hinge])
        counts = np.clip(np.ceil(np.diff(motion.planned[rows]) / TARGET_INTERVAL), MIN_INTERVALS, MAX_INTERVALS).astype(
            np.intp
        )
        return cls(hinge, limits, rows, keys.angles[rows, hinge], counts)

    def join(self, program: _Program, times: casadi.SX, motion: Conditioned, begin: Floats) -> None:
        """Add a hinge's variables and limit constraints to the program."""
        top = self._derivative_limits
        passed = np.concatenate([[0], np.cumsum(self.counts)])
        states, jerks = self._begin(motion, begin)
        lowest, highest = self._corridor()
        lower, upper = np.full(passed[-1] + 1, np.inf), np.full(passed[-1] + 1, -np.inf)
        for side in (np.s_[:-1], np.s_[1:]):
            lower[side], upper[side] = np.minimum(lower[side], lowest), np.maximum(upper[side], highest)
        lower[passed] = upper[passed] = states[0][passed] = self.angles
        rest = np.ones(passed[-1] + 1)
        rest[[0, -1]] = 0.0
        angle = program.variable(states[0], lower, upper)
        speed, bend = (
            program.variable(np.clip(state / limit, -rest, rest), -rest, rest)
            for state, limit in zip(states[1:], top, strict=False)
        )
        jerk = program.variable(np.clip(jerks / top[2], -1.0, 1.0), -1.0, 1.0)
        gaps = times[self.rows[1:].tolist()] - times[self.rows[:-1].tolist()]
        h = casadi.vertcat(*(casadi.repmat(gaps[k] / int(n), int(n), 1) for k, n in enumerate(self.counts)))
        q, v, a, j = angle[:-1], top[0] * speed[:-1], top[1] * bend[:-1], top[2] * jerk
        program.require((a + j * h) / top[1] - bend[1:], 0.0, 0.0)
        program.require((v + a * h + j * h**2 / 2) / top[0] - speed[1:], 0.0, 0.0)
        program.require(q + v * h + a * h**2 / 2 + j * h**3 / 6 - angle[1:], 0.0, 0.0)
        ends = angle[1:] - top[0] * speed[1:] * h / 3
        program.require(casadi.vertcat(q + v * h / 3, ends), np.tile(lowest, 2), np.tile(highest, 2))
        inertial, viscous, duty = (
            row[self.hinge] for row in (self.limits.inertial, self.limits.viscous, self.limits.duty)
        )
        pull, rise = inertial * a + viscous * v, inertial * j + viscous * a
        end = inertial * top[1] * bend[1:] + viscous * top[0] * speed[1:]
        program.require(casadi.vertcat(pull, end[-1]) / duty, -1.0, 1.0)
        _between(program, v / top[0], speed[1:], a * h / top[0], j * h**2 / top[0])
        _between(program, pull / duty, end / duty, rise * h / duty, viscous * j * h**2 / duty)

    def _corridor(self) -> tuple[Floats, Floats]:
        """Return the permitted angle range of each knot interval [rad]."""
        limits, n = self.limits, self.hinge
        low, high = np.minimum(self.angles[:-1], self.angles[1:]), np.maximum(self.angles[:-1], self.angles[1:])
        swing = np.maximum(SWING_FRACTION * (high - low), MIN_SWING)
        lower, upper = np.repeat(low - swing, self.counts), np.repeat(high + swing, self.counts)
        passed = np.cumsum(self.counts)[:-1]
        lower[passed] = lower[passed - 1] = np.minimum(lower[passed], lower[passed - 1])
        upper[passed] = upper[passed - 1] = np.maximum(upper[passed], upper[passed - 1])
        return np.maximum(lower, limits.lower[n]), np.minimum(upper, limits.upper[n])

    @property
    def _derivative_limits(self) -> tuple[float, float, float]:
        limits = self.limits
        n = self.hinge
        return float(limits.speed[n]), float(limits.acceleration[n]), float(limits.jerk[n])

    def _begin(self, motion: Conditioned, begin: Floats) -> tuple[list[Floats], Floats]:
        """Return the program's start values for angles, velocities, accelerations and jerks."""
        planned, first = motion.planned[self.rows], begin[self.rows]
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
        """Return the hinge's largest limit ratio on a dense time grid."""
        angle, speed, bend, jerk = values
        top, limits, n = self._derivative_limits, self.limits, self.hinge
        h = np.repeat(np.diff(times[self.rows]) / self.counts, self.counts)[:, None]
        q, v, a, j = angle[:-1, None], top[0] * speed[:-1, None], top[1] * bend[:-1, None], top[2] * jerk[:, None]
        s = DENSE_PARAMETERS * h
        angles, speeds, bends = q + v * s + a * s**2 / 2 + j * s**3 / 6, v + a * s + j * s**2 / 2, a + j * s
        half, middle = (limits.upper[n] - limits.lower[n]) / 2, (limits.upper[n] + limits.lower[n]) / 2
        duty = limits.inertial[n] * bends + limits.viscous[n] * speeds
        ratios = ((angles - middle) / half, speeds / top[0], bends / top[1], jerk, duty / limits.duty[n])
        return max(float(np.abs(ratio).max()) for ratio in ratios)


def _between(program: _Program, begin: casadi.SX, end: casadi.SX, slope: casadi.SX, bend: casadi.SX) -> None:
    """Require limit ratios, parabolic within knot intervals, to stay in -1..1.

    Args:
        program: of the rows.
        begin: (p,) limit ratios at the beginning of each knot interval.
        end: (p,) at the end.
        slope: (p,) of the parabola at the beginning, times the interval's duration.
        bend: (p,) of the parabola, times the square of the duration.
    """
    program.require(begin + slope / 4, -1.0, 1.0)
    program.require(end - (slope + bend) / 4, -1.0, 1.0)
    program.require((begin + end) / 2 - bend / 8, -1.0, 1.0)
