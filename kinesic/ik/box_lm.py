"""Levenberg-Marquardt least squares with bounds on the variables.

In each step, variables beyond a bound are clipped to it, and the others compensate.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed

MAX_ROUNDS = 40  # largest number of solver iterations
ERROR_DAMPING = 0.1  # coefficient of the base damping: lambda^2 = ERROR_DAMPING |e|^2 + MIN_DAMPING (Sugihara)
MIN_DAMPING = 1e-9  # base damping lambda^2 at zero error
POSTURE_GAIN = 0.4  # fraction of the distance to preferred values per iteration, before `POSTURE_DECAY`
POSTURE_DECAY = 0.7  # factor on `POSTURE_GAIN` per iteration, from the first on
STALL_RATIO = 0.98  # error ratio of successive iterations above which progress has stalled
MAX_STALLED_STEPS = 6  # successive stalled iterations that end the solver
DAMPING_GROWTH = 8.0  # factor on the damping after a rejected step, divisor after an accepted one

ErrorFunction = Callable[
    [Floats], tuple[Floats, Floats]
]  # (n,) -> error: target minus current value (m,), and Jacobian of the current value (m, n)


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds of the variables, with preferred values and mobilities."""

    lower: Floats  # (n,)
    upper: Floats  # (n,)
    home: Floats  # (n,) preferred values, reached as far as the errors permit
    mobility: Floats  # (n,) relative mobility: 1 usual, 0 fixed


@dataclass(frozen=True, eq=False)
class Descent:
    """Result of a bounded least-squares minimisation."""

    angles: Floats  # (n,) inside the box
    error: Floats  # (m,) in the units of the rows
    rounds: int

    @property
    def miss(self) -> float:
        """Norm of the remaining error, in the unit of the errors."""
        return float(np.linalg.norm(self.error))


def descend(errors: ErrorFunction, start: Floats, box: Box, *, tolerance: float) -> Descent:
    """Minimise errors by Levenberg-Marquardt within bounds, preferring the home values.

    Args:
        errors: rows of order one, such as distances relative to the arm's length.
        start: (n,) inside the box.
        box: of the variables.
        tolerance: norm of the error at which the descent ends.

    Returns:
        The best point evaluated.
    """
    current = np.array(start, dtype=np.float64)
    error, jacobian = errors(current)
    damping_factor, stalled, rounds = 1.0, 0, 0
    while (
        (error_norm := float(np.linalg.norm(error))) > tolerance and stalled < MAX_STALLED_STEPS and rounds < MAX_ROUNDS
    ):
        rounds += 1
        damping = damping_factor * (ERROR_DAMPING * error_norm * error_norm + MIN_DAMPING)
        pulls = POSTURE_GAIN * POSTURE_DECAY**rounds / damping_factor * (box.home - current) * (box.mobility > 0.0)
        trial = _step_within_box(current, error, jacobian, pulls, box, damping)
        trial_error, trial_jacobian = errors(trial)
        ratio = float(np.linalg.norm(trial_error)) / error_norm
        stalled = stalled + 1 if ratio > STALL_RATIO else 0
        is_worse = ratio >= 1.0
        damping_factor = DAMPING_GROWTH * damping_factor if is_worse else max(1.0, damping_factor / DAMPING_GROWTH)
        if ratio < 1.0:
            current, error, jacobian = trial, trial_error, trial_jacobian
    return Descent(sealed(current), sealed(error), rounds)


def _step_within_box(
    current: Floats, error: Floats, jacobian: Floats, pulls: Floats, box: Box, damping: float
) -> Floats:
    """Return the variables after one damped Gauss-Newton step within bounds.

    The step is dq = p + W J^T (J W J^T + lambda^2)^-1 (e - J p), solved again without variables at their limits.
    """
    result, is_free = current.copy(), box.mobility > 0.0
    damping_matrix = damping * np.eye(len(error))
    while is_free.any():
        columns = jacobian * is_free
        weighted = columns * box.mobility
        push = np.linalg.solve(weighted @ columns.T + damping_matrix, error - columns @ pulls)
        target = current + pulls + weighted.T @ push
        clipped = np.clip(target, box.lower, box.upper)
        is_clipped = is_free & (clipped != target)
        is_final = is_clipped if is_clipped.any() else is_free
        result[is_final] = clipped[is_final]
        error = error - jacobian[:, is_final] @ (clipped - current)[is_final]
        is_free = is_free & ~is_final
    return result
