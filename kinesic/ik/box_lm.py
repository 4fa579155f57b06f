"""Levenberg-Marquardt inside a box for any number of rows: what `polish` is for one hand, for poses and for two hands.

A variable that meets its stop stays there and the others take over what it cannot give.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed

ROUNDS = 40
DAMPING = 0.1  # lambda^2 = DAMPING e^2 + LEAST_DAMPING (after Sugihara)
LEAST_DAMPING = 1e-9
POSTURE = 0.4  # share of the way back to the posture in a round, as far as the errors do not notice ...
FADING = 0.7  # ... less from round to round
STALL = 0.98  # a round that leaves more than this share of the error ...
STALLED_STEPS = 6  # ... so many times in a row has come to a rest
CAUTION = 8.0  # times the damping after a round that lost ground

ErrorFunction = Callable[
    [Floats], tuple[Floats, Floats]
]  # (n,) -> wanted minus present (m,), and d present / d q (m, n)


@dataclass(frozen=True, eq=False)
class Box:
    """Ranges of the variables, and how readily each moves."""

    lower: Floats  # (n,)
    upper: Floats  # (n,)
    home: Floats  # (n,) to which springs pull what the errors leave open
    mobility: Floats  # (n,) how readily each moves: 1 for an ordinary one, 0 for one that is fixed


@dataclass(frozen=True, eq=False)
class Descent:
    """The point at which a descent came to rest."""

    angles: Floats  # (n,) inside the box
    error: Floats  # (m,) in the units of the rows
    rounds: int

    @property
    def miss(self) -> float:
        """Length of the error."""
        return float(np.linalg.norm(self.error))


def descend(errors: ErrorFunction, start: Floats, box: Box, *, tolerance: float) -> Descent:
    """Makes errors small by Levenberg-Marquardt.

    Args:
        errors: rows of order one, such as metres in units of the arm's length.
        start: (n,) inside the box.
        box: of the variables.
        tolerance: length of the error that is good enough.

    Returns:
        The best point met.
    """
    now = np.array(start, dtype=np.float64)
    error, jacobian = errors(now)
    caution, stalled, rounds = 1.0, 0, 0
    while (least := float(np.linalg.norm(error))) > tolerance and stalled < STALLED_STEPS and rounds < ROUNDS:
        rounds += 1
        damping = caution * (DAMPING * least * least + LEAST_DAMPING)
        pulls = POSTURE * FADING**rounds / caution * (box.home - now) * (box.mobility > 0.0)
        tried = _stepped(now, error, jacobian, pulls, box, damping)
        tried_error, tried_jacobian = errors(tried)
        gain = float(np.linalg.norm(tried_error)) / least
        stalled = stalled + 1 if gain > STALL else 0
        caution = CAUTION * caution if gain >= 1.0 else max(1.0, caution / CAUTION)
        if gain < 1.0:
            now, error, jacobian = tried, tried_error, tried_jacobian
    return Descent(sealed(now), sealed(error), rounds)


def _stepped(now: Floats, error: Floats, jacobian: Floats, pulls: Floats, box: Box, damping: float) -> Floats:
    """One damped step dq = p + W J^T (J W J^T + lambda^2)^-1 (e - J p); solved again without what is stopped."""
    stepped, free = now.copy(), box.mobility > 0.0
    level = damping * np.eye(len(error))
    while free.any():
        columns = jacobian * free
        eased = columns * box.mobility
        push = np.linalg.solve(eased @ columns.T + level, error - columns @ pulls)
        wanted = now + pulls + eased.T @ push
        held = np.clip(wanted, box.lower, box.upper)
        stopped = free & (held != wanted)
        settled = stopped if stopped.any() else free
        stepped[settled] = held[settled]
        error = error - jacobian[:, settled] @ (held - now)[settled]
        free = free & ~settled
    return stepped
