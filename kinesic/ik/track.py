"""Tracking of a moving hand target at a fixed rate, without drift.

Each step corrects the previous angles, without closed forms or other start postures, whose branches would make the arm
leap. Redundant degrees of freedom return to the rest posture with a time constant, so that a closed path of the hand
is a closed path of the arm.
"""

from collections.abc import Iterable, Iterator
from math import ceil, exp

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.ik.arm.compiled import arm_of

MAX_STEP = 0.005  # [s] longer time steps are divided, so that results hardly depend on the rate
RAMP_TIME_CONSTANTS = 4.0  # time constants until the pull towards the rest posture has full strength


class Tracker:
    """Tracker of a moving hand target, one time step per call.

    Attributes:
        residual: [m] from the hand to the last target.
    """

    def __init__(
        self,
        chain: Chain,
        *,
        period: float,
        start: Floats | None = None,
        posture_seconds: float = 0.25,
    ) -> None:
        """Start tracking from an arm posture.

        Args:
            chain: the arm.
            period: [s] between two steps.
            start: (k,) [rad] clipped to the ranges; the chain's rest by default.
            posture_seconds: [s] time constant of the pull to rest; infinite for none.

        Raises:
            ValueError: a time is not positive, or the start no posture.
        """
        if not (0.0 < period < np.inf and posture_seconds > 0.0):
            raise ValueError(f"period is {period} s and posture_seconds {posture_seconds} s; both must be positive")
        angles = np.array(chain.rest if start is None else start, dtype=np.float64)
        if angles.shape != chain.rest.shape or not np.isfinite(angles).all():
            raise ValueError(f"start is {angles.tolist()}; it needs {len(chain.rest)} finite numbers")
        self.residual = 0.0
        self._angles: Floats = np.clip(angles, chain.lower, chain.upper)
        self._parts = max(1, ceil(period / MAX_STEP - 1e-9))
        self._pull = 1.0 - exp(-period / self._parts / posture_seconds)
        self._strength, self._growth = 0.0, period / (RAMP_TIME_CONSTANTS * posture_seconds)
        self._follow = arm_of(chain).track

    def step(self, target: Floats) -> Floats:
        """Advance the arm by one time step towards the target.

        Args:
            target: (3,) [m] of the hand, in the frame of the chain's base. In the last twentieth of the reach the hand
                stays behind it, further and further.

        Returns:
            (k,) [rad] inside the ranges.

        Raises:
            ValueError: the target is not three finite numbers.
        """
        self.residual = self._follow(target, self._pull * self._strength, self._parts, self._angles)
        if self._strength < 1.0:
            self._strength = min(1.0, self._strength + self._growth)
        return self._angles.copy()


def track(
    chain: Chain,
    targets: Iterable[Floats],
    *,
    period: float,
    start: Floats | None = None,
    posture_seconds: float = 0.25,
) -> Iterator[Floats]:
    """Yield arm postures that track a sequence of targets.

    Args:
        chain: the arm.
        targets: (3,) [m] each, of the hand in the frame of the chain's base, one per period.
        period: [s] between two targets.
        start: (k,) [rad] clipped to the ranges; the chain's rest by default.
        posture_seconds: [s] time constant of the pull to rest; infinite for none.

    Returns:
        (k,) [rad] for each target, inside the ranges.

    Raises:
        ValueError: a time is not positive, the start no posture, or a target not three finite numbers.
    """
    tracker = Tracker(chain, period=period, start=start, posture_seconds=posture_seconds)
    return map(tracker.step, targets)
