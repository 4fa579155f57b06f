"""Forecast of the clearance if recent tracking errors recur."""

import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.body.dynamics import Distances

LOOK_PERIOD = 0.05  # [s] between clearance checks
ERROR_MEMORY = 1.0  # [s] time during which a tracking error is expected to recur
LOOKS_PER_ERROR = 2  # one tracking error is considered per this many clearance checks, as errors change slowly


def forecast_clearance(planned: Floats, measured: Floats, distances: Distances, *, every: int) -> Floats:
    """Predict the clearance of planned postures if recent tracking errors recur.

    Args:
        planned: (m, n) [rad].
        measured: (m, n) [rad] at the same times.
        distances: of the robot.
        every: samples from one evaluated posture to the next.

    Returns:
        (k,) [m] smallest clearance per evaluated posture, with any error of the last `ERROR_MEMORY` seconds in both
        directions. Postures that cannot have the smallest clearance of all get a lower bound, which is not below it.
    """
    postures = planned[::every]
    errors = measured[::every] - postures
    lags = range(0, min(round(ERROR_MEMORY / (LOOKS_PER_ERROR * LOOK_PERIOD)) + 1, len(postures)), LOOKS_PER_ERROR)
    max_errors = np.zeros_like(errors)
    for lag in lags:
        max_errors[lag:] = np.maximum(max_errors[lag:], np.abs(errors[: len(postures) - lag]))
    clearances = distances.bounds(postures, max_errors)  # lower bounds: above an exact value they need no evaluation
    nearest = np.array([clearances.argmin()])
    clearances[nearest] = _compute_clearances(nearest, postures, errors, lags, distances)
    candidates = np.flatnonzero(clearances < clearances[nearest])
    if candidates.size:
        clearances[candidates] = _compute_clearances(candidates, postures, errors, lags, distances)
    return clearances


def _compute_clearances(rows: Indices, postures: Floats, errors: Floats, lags: range, distances: Distances) -> Floats:
    """Compute smallest clearances (a,) [m] of postures displaced by past tracking errors.

    Args:
        rows: (a,) indices of the postures.
        postures: (k, n) [rad].
        errors: (k, n) [rad].
        lags: numbers of postures between an error and the posture it is added to.
        distances: of the robot.
    """
    pairs = [(row, row - lag) for row in rows for lag in lags if lag <= row]
    posture_rows, sources = np.array(pairs, dtype=np.intp).T
    disturbed = [postures[posture_rows] + sign * errors[sources] for sign in (1.0, -1.0)]
    smallest = distances.clearance(np.concatenate(disturbed)).distances.reshape(2, -1).min(axis=0)
    return np.minimum.reduceat(smallest, np.flatnonzero(np.diff(posture_rows, prepend=-1)))
