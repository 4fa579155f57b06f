"""Robot parameters that a log determines independently."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.sim.fitting.parameters import Unknown

DATASHEET_DEVIATION = 0.5  # prior standard deviation of a fitted variable: 50 % of a factor, 5 ms of latency
MAX_KNOWN_DEVIATION = 0.02  # standard deviation of a fitted variable up to which it is identified


@dataclass(frozen=True, eq=False)
class Identifiability:
    """Whether a log determines each unknown parameter, with standard deviations and reasons."""

    is_identified: Flags  # (u,) whether the log determines each unknown
    deviations: Floats  # (u,) standard deviation of each fitted variable, with the others unknown
    reasons: Mapping[int, str]  # reason for each unknown that is not identified, by index


def find_assumed_gains(unknowns: Sequence[Unknown], slopes: Floats) -> dict[int, str]:
    """Find servo gains that a log cannot distinguish from other parameters.

    Such gains are taken from the description.

    Args:
        unknowns: (u,) unknowns of the fit.
        slopes: (r, u) derivatives of the errors, in units of the noise.

    Returns:
        Index of the unknown -> reason.
    """
    deviations, most_correlated = _compute_deviations(slopes, scatter=1.0)
    return {
        k: f"the log does not distinguish it from {unknowns[most_correlated[k]]}"
        for k, unknown in enumerate(unknowns)
        if unknown.figure == "gain" and deviations[k] > MAX_KNOWN_DEVIATION
    }


def find_identifiable(
    unknowns: Sequence[Unknown], slopes: Floats, *, assumed: Mapping[int, str], scatter: float
) -> Identifiability:
    """Find the unknown parameters that a log determines.

    Args:
        unknowns: (u,) unknowns of the fit.
        slopes: (r, u) derivatives of the errors, in units of the noise.
        assumed: Unknowns that are taken from the description, with the reason.
        scatter: RMS of the remaining errors, in units of the noise.
    """
    free_indices = [k for k in range(len(unknowns)) if k not in assumed]
    deviations, reasons = np.full(len(unknowns), DATASHEET_DEVIATION), dict(assumed)
    spread, most_correlated = _compute_deviations(slopes[:, free_indices], scatter=scatter)
    deviations[free_indices] = spread
    for column, k in enumerate(free_indices):
        if deviations[k] <= MAX_KNOWN_DEVIATION:
            continue
        lone_deviation = scatter / max(float(np.linalg.norm(slopes[:, k])), np.finfo(float).tiny)
        partner = unknowns[free_indices[most_correlated[column]]]
        reasons[k] = (
            "the log hardly depends on it"
            if lone_deviation > MAX_KNOWN_DEVIATION
            else f"the log does not distinguish it from {partner}"
        )
    is_identified = np.array([k not in reasons for k in range(len(unknowns))])
    return Identifiability(is_identified, sealed(deviations), reasons)


def _compute_deviations(slopes: Floats, *, scatter: float) -> tuple[Floats, list[int]]:
    """Compute each unknown parameter's standard deviation and most correlated other parameter.

    Args:
        slopes: (r, u) derivatives of the errors, in units of the noise.
        scatter: RMS of the remaining errors, in units of the noise.

    Returns:
        (u,) standard deviations, and the index of the most correlated other unknown.
    """
    count = slopes.shape[1]
    covariance = np.linalg.inv(slopes.T @ slopes / scatter**2 + np.eye(count) / DATASHEET_DEVIATION**2)
    deviations = np.sqrt(covariance.diagonal())
    correlations = np.abs(covariance / np.outer(deviations, deviations)) - np.eye(count)
    return deviations, [int(k) for k in correlations.argmax(axis=0)]
