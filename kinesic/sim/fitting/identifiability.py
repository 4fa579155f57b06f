"""Identifiability: which unknowns of a robot a log determines, whatever the others are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.sim.fitting.parameters import Unknown

SHEET = 0.5  # standard deviation of a value about the data sheet's, before any log
KNOWN = 0.02  # standard deviation up to which a value is known


@dataclass(frozen=True, eq=False)
class Identifiability:
    """Which unknowns a log determines, and how well."""

    known: Flags  # (u,)
    deviations: Floats  # (u,) standard deviation of each value, whatever the others are
    reasons: Mapping[int, str]  # why the others are not


def assumptions(of: Sequence[Unknown], slopes: Floats) -> dict[int, str]:
    """Finds gains that a log cannot tell from stall torques, and which are therefore taken as described.

    Args:
        of: (u,) unknowns.
        slopes: (r, u) derivatives of the errors, in units of the noise.

    Returns:
        Position -> why.
    """
    deviations, likest = _spread(slopes, scatter=1.0)
    return {
        k: f"the log cannot tell it from {of[likest[k]]}"
        for k, unknown in enumerate(of)
        if unknown.figure == "gain" and deviations[k] > KNOWN
    }


def identifiable(
    of: Sequence[Unknown], slopes: Floats, *, assumed: Mapping[int, str], scatter: float
) -> Identifiability:
    """Finds the unknowns that a log determines.

    Args:
        of: (u,) unknowns.
        slopes: (r, u) derivatives of the errors, in units of the noise.
        assumed: those that are taken as described, with the reason.
        scatter: RMS of the errors that remain, in units of the noise.
    """
    free = [k for k in range(len(of)) if k not in assumed]
    deviations, reasons = np.full(len(of), SHEET), dict(assumed)
    spread, likest = _spread(slopes[:, free], scatter=scatter)
    deviations[free] = spread
    for place, k in enumerate(free):
        if deviations[k] <= KNOWN:
            continue
        alone = scatter / max(float(np.linalg.norm(slopes[:, k])), np.finfo(float).tiny)
        twin = of[free[likest[place]]]
        reasons[k] = "the log hardly depends on it" if alone > KNOWN else f"the log cannot tell it from {twin}"
    known = np.array([k not in reasons for k in range(len(of))])
    return Identifiability(known, sealed(deviations), reasons)


def _spread(slopes: Floats, *, scatter: float) -> tuple[Floats, list[int]]:
    """(u,) standard deviations of unknowns that are all open, and with which other one each is most confounded."""
    count = slopes.shape[1]
    covariance = np.linalg.inv(slopes.T @ slopes / scatter**2 + np.eye(count) / SHEET**2)
    deviations = np.sqrt(covariance.diagonal())
    alike = np.abs(covariance / np.outer(deviations, deviations)) - np.eye(count)
    return deviations, [int(k) for k in alike.argmax(axis=0)]
