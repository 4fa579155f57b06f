"""Observer inputs computed tick by tick, for slowed motions."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.controller.observer import (
    FORGETTING_TIME,
    MAX_CORRECTION,
    REGULARISATION_OFFSET,
    Observer,
    ObserverInputs,
    detection_rate,
)


class InputStream:
    """Observer inputs of one robot, computed tick by tick."""

    def __init__(self, observer: Observer) -> None:
        """Prepare the stream of observer inputs, before its first tick.

        Args:
            observer: of one body.
        """
        self._observer, hinges = observer, len(observer.lower)
        self._offsets: list[Floats] = []  # (2, n) [rad] torque and velocity offsets of the last ticks
        self._noticed, self._information = np.zeros((2, hinges)), np.zeros(hinges)

    def add(self, angles: Floats, setpoints: FeedForwardSetpoints) -> ObserverInputs:
        """Add a tick and return its observer inputs.

        They equal those of `Observer.precompute_inputs`.

        Args:
            angles: (n,) [rad] reference.
            setpoints: feed-forward of this tick alone.
        """
        observer, count = self._observer, len(self._observer.arrival)
        offsets = np.stack([setpoints.loads[0], setpoints.leads[0]])
        if not self._offsets:
            self._offsets, self._noticed = [offsets] * (count + 2), offsets
        self._offsets = [*self._offsets[1:], offsets]
        acting = sum(fraction * self._offsets[-3 - k] for k, fraction in enumerate(observer.arrival))
        self._noticed = self._noticed + detection_rate(observer.period) * (acting - self._noticed)
        self._information = (1.0 - observer.period / FORGETTING_TIME) * self._information + np.sum(
            self._noticed**2, axis=0
        )
        trust = self._noticed / (REGULARISATION_OFFSET**2 + self._information)
        goals = setpoints.setpoints[0]
        lowest, highest = (
            np.maximum(observer.lower, goals - MAX_CORRECTION),
            np.minimum(observer.upper, goals + MAX_CORRECTION),
        )
        (load, lead), (noticed, noticed_lead), (trust_load, trust_lead) = offsets, self._noticed, trust
        rows = angles, goals, lowest, highest, load, noticed, trust_load, lead, noticed_lead, trust_lead
        return ObserverInputs(*(row[None] for row in rows))
