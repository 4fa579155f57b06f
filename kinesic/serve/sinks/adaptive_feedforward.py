"""Feed-forward for one output (sink), with a servo model that may change.

The feed-forward starts with the estimated servo model. After an update, it blends to the new model within one second.
"""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.learned_gains import LearnedGains
from kinesic.planning.setup import Setup
from kinesic.sim.servo_factors import Factors

TRANSITION_DURATION = 1.0  # [s] duration of blending to a new servo model, so that setpoints do not jump


class AdaptiveFeedForward:
    """Feed-forward whose servo model can change during a performance."""

    def __init__(self, estimate: Factors, *, delay: float) -> None:
        """Create a feed-forward for an estimated servo model.

        Args:
            estimate: estimated deviations of the servos from their data sheets.
            delay: minimum delay [s], that of the bus.
        """
        self._before = self._after = estimate
        self._since, self._delay = -np.inf, delay  # [s]
        self._gains: tuple[LearnedGains, LearnedGains] | None = None  # of both models, cached

    def change(self, estimate: Factors, since: float) -> None:
        """Blend to another servo model, starting at a time [s]."""
        self._before, self._after, self._since, self._gains = self._after, estimate, since, None

    def feedforward(self, setup: Setup, times: Floats) -> FeedForward:
        """Return the feed-forward for setpoints sent at (m,) times [s]."""
        if self._gains is None:
            before, after = (LearnedGains.of_twin(setup.robot, factors) for factors in (self._before, self._after))
            self._gains = before, after
        before, learned = self._gains
        if times[0] < self._since + TRANSITION_DURATION:
            learned = before.towards(learned, np.clip((times - self._since) / TRANSITION_DURATION, 0.0, 1.0))
        delay = np.maximum(self._delay, learned.delay)
        return FeedForward(setup.robot, setup.dynamics, delay=delay, learned=learned)
