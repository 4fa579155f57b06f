"""A move that nobody has planned: all joints together from one posture to another, as smoothly as can be."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed

PEAK = 15 / 8  # peak over mean speed of the minimum-jerk curve
LEAST = 0.3  # [s]


@dataclass(frozen=True, eq=False)
class TimedMove:
    """Minimum jerk from rest to rest (Flash and Hogan, 1985)."""

    start: Floats  # (n,) [rad]
    goal: Floats  # (n,) [rad]
    duration: float  # [s]

    @classmethod
    def between(cls, start: Floats, goal: Floats, *, pace: float) -> "TimedMove":
        """A way on which no joint is faster than a pace [rad/s]; of no duration between equal postures."""
        longest = float(np.abs(goal - start).max(initial=0.0))
        duration = 0.0 if longest < 1e-9 else max(LEAST, PEAK * longest / pace)
        return cls(sealed(start), sealed(goal), duration)

    def at(self, time: float) -> Floats:
        """(n,) [rad] at a time [s] from its start."""
        if time >= self.duration:
            return self.goal
        u = max(0.0, time / self.duration)
        share = u**3 * (10 - 15 * u + 6 * u**2)
        there: Floats = self.start + share * (self.goal - self.start)
        return there
