"""Fits servo factors so that the twin reproduces a log.

Angles alone do not tell everything. All torques of the equation of motion may be scaled together without a trace, so
masses are taken as described. And of gain, stall torque and no-load speed they show stall x gain and stall / no-load
speed; the three show apart only where the duty saturates, so the gain is else taken as described, too. A figure is
fitted only if the log tells it whatever the other figures are.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import count, pairwise

import msgspec
import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.sim.fitting.identifiability import SHEET, Identifiability, assumptions, identifiable
from kinesic.sim.fitting.parameters import DEFAULT, ServoFigure, Unknown, bounds, factors_of, unknowns
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import Factors
from kinesic.sim.twin import Twin

REPLAY_STEP = 0.002  # [s] of the physics, at most: half the twin's, as what its steps do wrong would go into the fit
NO_STEP = 1e-9  # of a step, below which what is left over is none
DIFFERENCE_STEP = 0.01  # of finite differences
EVALUATIONS = 15  # of the errors, at most
LATEST = 64  # errors that are remembered: slopes and steps ask again where they are
FIT_TOLERANCE = 1e-3  # relative change of the figures at which a fit ends


@dataclass(frozen=True)
class Estimate:
    """What the log says about one figure."""

    unknown: Unknown
    value: float  # factor, or latency [s]
    deviation: float  # standard deviation, in the same unit; of a figure that is not told, what it would be
    why: str = ""  # it is not told, and left as the data sheet has it


@dataclass(frozen=True)
class Fit:
    """The twin that repeats a log best."""

    factors: Factors
    estimates: tuple[Estimate, ...]
    before: float  # [rad] RMS of the twin's angles minus those of the log, servos as in their data sheets
    after: float  # [rad] the same with the factors found


def fit_factors(
    log: Log,
    robot: Robot,
    *,
    free: tuple[ServoFigure, ...] = DEFAULT,
    progress: Callable[[int], None] = lambda count: None,
) -> Fit:
    """Fits factors to a log.

    Args:
        log: goals and angles of the whole robot.
        robot: as its data sheets describe it.
        free: figures that may differ from them.
        progress: gets, after each replay of the log, how many there were; nobody knows how many there will be.

    Returns:
        The same for the same log: nothing is random.

    Raises:
        ValueError: both stall and mass are free.
    """
    asked = unknowns(robot, free)
    noise = robot.drives.tick / 2  # of a rounded angle; neighbours are rounded alike

    replays = count(1)

    @lru_cache(maxsize=LATEST)
    def errors_at(*values: float) -> Floats:
        found = replay_log(log, robot, factors_of(asked, np.array(values)))
        progress(next(replays))
        return sealed(((found - log.angles) / noise).ravel())

    def errors(values: Floats) -> Floats:
        return errors_at(*values.tolist())

    sheet = np.zeros(len(asked))
    described = errors(sheet)
    assumed = assumptions(asked, _slopes(errors, sheet, range(len(asked)))) if "gain" in free else {}
    values = _solved(errors, asked, [k for k in range(len(asked)) if k not in assumed])
    scatter = max(1.0, _rms(errors(values)))
    found = identifiable(asked, _slopes(errors, values, range(len(asked))), assumed=assumed, scatter=scatter)
    values = np.where(found.known, values, 0.0)
    spacing = np.tile(noise, len(log.times))
    return Fit(
        factors_of(asked, values),
        tuple(_estimate(asked[k], values[k], found, k) for k in range(len(asked))),
        _rms(described * spacing),
        _rms(errors(values) * spacing),
    )


def _solved(errors: Callable[[Floats], Floats], asked: Sequence[Unknown], chosen: list[int]) -> Floats:
    """(u,) values that make errors and distrust of the data sheets smallest; those not chosen are zero."""
    if not chosen:
        return np.zeros(len(asked))

    def whole(part: Floats) -> Floats:
        values = np.zeros(len(asked))
        values[chosen] = part
        return values

    solved = scipy.optimize.least_squares(
        lambda part: np.concatenate([errors(whole(part)), part / SHEET]),
        np.zeros(len(chosen)),
        jac=lambda part: np.concatenate([_slopes(errors, whole(part), chosen), np.eye(len(chosen)) / SHEET]),
        bounds=bounds([asked[k] for k in chosen]),
        # lsmr decomposes no slopes, which are as long as the log, but cannot do with one unknown
        tr_solver="lsmr" if len(chosen) > 1 else "exact",
        xtol=FIT_TOLERANCE,
        ftol=FIT_TOLERANCE,
        max_nfev=EVALUATIONS,
    )
    return whole(solved.x)


def _slopes(errors: Callable[[Floats], Floats], values: Floats, chosen: Sequence[int]) -> Floats:
    """(r, c) derivatives of the errors by the chosen values."""
    here = errors(values)
    slopes = np.empty((len(here), len(chosen)))
    for column, k in enumerate(chosen):
        moved = values.copy()
        moved[k] += DIFFERENCE_STEP
        slopes[:, column] = (errors(moved) - here) / DIFFERENCE_STEP
    return slopes


def _estimate(unknown: Unknown, value: float, found: Identifiability, k: int) -> Estimate:
    deviation = unknown.scale(value) * float(found.deviations[k])
    return Estimate(unknown, unknown.figure_of(value), deviation, found.reasons.get(k, ""))


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def replay_log(log: Log, robot: Robot, factors: Factors) -> Floats:
    """Sends a twin what a log says was sent, and tells where it is at the log's times.

    Goals that arrive within a step of the physics count by their share of it: a step that is cut in two where they
    arrive would make the angles jump with the latency, and no fit could follow.

    Args:
        log: begins at rest.
        robot: as its data sheets describe it.
        factors: how far the twin is from it.

    Returns:
        (m, n) [rad].
    """
    spans = np.diff(log.times)
    counts = np.ceil(spans / REPLAY_STEP - NO_STEP).astype(int)
    pieces = [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(pairwise(log.times), counts, strict=True)]
    steps = np.append(np.concatenate(pieces), log.times[-1])
    goals = np.diff(_sums(log, steps - factors.latency), axis=0) / np.diff(steps)[:, None]
    prompt = msgspec.structs.replace(factors, latency=0.0)
    twin = Twin(robot, factors=prompt, start=log.angles[0], rounds=False, step=REPLAY_STEP)
    return twin.replay(steps, goals, {0, *np.cumsum(counts).tolist()})


def _sums(log: Log, times: Floats) -> Floats:
    """(k, n) [rad s] integral of the goals in force up to (k,) [s]; before the first, of where the log begins."""
    last = np.searchsorted(log.times, times, side="right") - 1
    in_force = np.where((last < 0)[:, None], log.angles[0], log.goals[last])
    so_far = np.cumsum(log.goals[:-1] * np.diff(log.times)[:, None], axis=0)
    whole = np.concatenate([np.zeros((1, log.goals.shape[1])), so_far])[np.maximum(last, 0)]
    sums: Floats = whole + in_force * (times - log.times[np.maximum(last, 0)])[:, None]
    return sums
