"""How the goals of one sink lead: as its servos are believed to be, and, once they have told, over a second as that."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.learned_gains import LearnedGains
from kinesic.planning.setup import Setup
from kinesic.sim.servo_factors import Factors

OVER = 1.0  # [s] in which goals go over from one belief to the next, so that they do not jump


class Leading:
    """Feed-forward whose belief may change while it leads."""

    def __init__(self, believed: Factors, *, delay: float) -> None:
        """Leads as servos are believed to be.

        Args:
            believed: how far they are from their data sheets.
            delay: [s] of the bus, at least.
        """
        self._before = self._after = believed
        self._since, self._delay = -np.inf, delay  # [s]
        self._gains: tuple[LearnedGains, LearnedGains] | None = None  # of both; worked out once

    def change(self, believed: Factors, since: float) -> None:
        """Leads as servos are believed to be from now on, beginning at a time [s]."""
        self._before, self._after, self._since, self._gains = self._after, believed, since, None

    def feedforward(self, known: Setup, times: Floats) -> FeedForward:
        """Leads goals that are sent at (m,) times [s]."""
        if self._gains is None:
            before, after = (LearnedGains.of_twin(known.robot, each) for each in (self._before, self._after))
            self._gains = before, after
        before, learned = self._gains
        if times[0] < self._since + OVER:
            learned = before.towards(learned, np.clip((times - self._since) / OVER, 0.0, 1.0))
        delay = np.maximum(self._delay, learned.delay)
        return FeedForward(known.robot, known.dynamics, delay=delay, learned=learned)
