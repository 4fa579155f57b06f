"""Bounded nonlinear least squares by the method of Levenberg and Marquardt.

For problems of some ten unknowns whose Jacobian has full rank. Steps are clipped to the bounds, and unknowns at a bound
that the cost pushes outward are held (projected Newton method, Bertsekas 1982).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed

INITIAL_DAMPING = 1e-3  # initial damping, relative to the largest diagonal entry of the normal equations
DAMPING_DECREASE = 1.0 / 3.0  # smallest factor on the damping after a step that reduces the cost
DAMPING_INCREASE = 2.0  # factor on the damping after a rejected step, doubled after each further one
MAX_DAMPING = 1e16  # damping above which the search ends, as steps vanish in rounding
RELATIVE_DIFFERENCE_STEP = np.finfo(np.float64).eps ** 0.5  # step of forward differences / max(1, |value|)


@dataclass(frozen=True, eq=False)
class Minimum:
    """Values that minimise a sum of squares within their bounds."""

    values: Floats  # (n,)
    cost: float  # half the sum of squared residuals


def minimise_squares(
    residuals: Callable[[Floats], Floats],
    start: Floats,
    *,
    bounds: tuple[Floats, Floats],
    max_evaluations: int,
    jacobian: Callable[[Floats], Floats] | None = None,
    tolerance: float = 1e-8,
) -> Minimum:
    """Find the values that locally minimise a sum of squared residuals.

    Args:
        residuals: values (n,) -> residuals (m,).
        start: (n,) values within the bounds.
        bounds: (n,) lower and (n,) upper bounds, infinite without one.
        max_evaluations: largest number of evaluations, not counting those for differences.
        jacobian: values (n,) -> (m, n) derivatives; forward differences by default.
        tolerance: relative change of the cost, or of the values, at which the search ends.
    """
    lower, upper = bounds

    def derive(values: Floats, errors: Floats) -> Floats:
        return _differentiate(residuals, values, errors, upper) if jacobian is None else jacobian(values)

    values, errors = start, residuals(start)
    cost, slopes = 0.5 * float(errors @ errors), derive(start, errors)
    damping, increase = INITIAL_DAMPING, DAMPING_INCREASE
    for _ in range(max_evaluations - 1):
        gradient, curvature = slopes.T @ errors, slopes.T @ slopes
        scale, smallest = float(curvature.diagonal().max()), tolerance * (tolerance + np.linalg.norm(values))
        gradient_step = np.clip(values - gradient / scale, lower, upper) - values
        if np.linalg.norm(gradient_step) <= smallest or damping > MAX_DAMPING:
            break
        trial = np.clip(values + _find_step(gradient, curvature, values, lower, upper, damping), lower, upper)
        step = trial - values
        if np.linalg.norm(step) <= smallest:  # held at bounds by the other unknowns: more damping frees it
            damping, increase = damping * increase, increase * DAMPING_INCREASE
            continue
        new_errors = residuals(trial)
        decrease = cost - 0.5 * float(new_errors @ new_errors)
        if decrease <= 0.0:
            damping, increase = damping * increase, increase * DAMPING_INCREASE
            continue
        predicted = -float(gradient @ step + 0.5 * step @ curvature @ step)
        gain = decrease / predicted if predicted > 0.0 else 0.0
        damping *= max(DAMPING_DECREASE, 1.0 - (2.0 * gain - 1.0) ** 3)
        values, errors, increase = trial, new_errors, DAMPING_INCREASE
        has_converged, cost = decrease <= tolerance * cost, cost - decrease
        if has_converged:
            break
        slopes = derive(values, errors)
    return Minimum(sealed(values), cost)


def _find_step(
    gradient: Floats, curvature: Floats, values: Floats, lower: Floats, upper: Floats, damping: float
) -> Floats:
    """Return the damped Gauss-Newton step (n,) within the bounds.

    Unknowns that would leave their bounds go to these, and the others are solved again.
    """
    is_free = ~(((values <= lower) & (gradient > 0.0)) | ((values >= upper) & (gradient < 0.0)))
    system = curvature + damping * curvature.diagonal().max() * np.eye(len(values))
    step = np.zeros_like(values)
    while is_free.any():
        right_side = -gradient[is_free] - system[np.ix_(is_free, ~is_free)] @ step[~is_free]
        step[is_free] = np.linalg.solve(system[np.ix_(is_free, is_free)], right_side)
        clipped = np.clip(values + step, lower, upper) - values
        is_outside = is_free & (clipped != step)
        if not is_outside.any():
            break
        step[is_outside] = clipped[is_outside]
        is_free &= ~is_outside
    return step


def _differentiate(residuals: Callable[[Floats], Floats], values: Floats, errors: Floats, upper: Floats) -> Floats:
    """Return the Jacobian (m, n) by forward differences, backward at upper bounds."""
    slopes = np.empty((len(errors), len(values)))
    for k, size in enumerate(RELATIVE_DIFFERENCE_STEP * np.maximum(1.0, np.abs(values))):
        shifted = values.copy()
        shifted[k] += size if values[k] + size <= upper[k] else -size
        slopes[:, k] = (residuals(shifted) - errors) / (shifted[k] - values[k])
    return slopes
