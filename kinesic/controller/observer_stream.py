"""Finds the observer's inputs tick by tick, for motions whose pace is not known before."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.controller.feedforward import FeedForwardGoals
from kinesic.controller.observer import CLEAR_LOAD, FORGETTING, LARGEST_CORRECTION, Observer, ObserverInputs, noticing


class InputStream:
    """The inputs of ticks so far, as the next ones need them."""

    def __init__(self, observer: Observer) -> None:
        """Before the first tick; `observer` of one body."""
        self._observer, hinges = observer, len(observer.lower)
        self._led: list[Floats] = []  # (2, n) [rad] loads and leads of the last ticks
        self._noticed, self._learned = np.zeros((2, hinges)), np.zeros(hinges)

    def add(self, angles: Floats, setpoints: FeedForwardGoals) -> ObserverInputs:
        """Adds a tick, and returns its inputs: what `precompute_inputs` gives for it.

        Args:
            angles: (n,) [rad] reference.
            setpoints: of this tick alone.
        """
        observer, late = self._observer, len(self._observer.arrival)
        led = np.stack([setpoints.loads[0], setpoints.leads[0]])
        if not self._led:
            self._led, self._noticed = [led] * (late + 2), led
        self._led = [*self._led[1:], led]
        acting = sum(share * self._led[-3 - k] for k, share in enumerate(observer.arrival))
        self._noticed = self._noticed + noticing(observer.period) * (acting - self._noticed)
        self._learned = (1.0 - observer.period / FORGETTING) * self._learned + np.sum(self._noticed**2, axis=0)
        trust = self._noticed / (CLEAR_LOAD**2 + self._learned)
        goals = setpoints.goals[0]
        lowest, highest = (
            np.maximum(observer.lower, goals - LARGEST_CORRECTION),
            np.minimum(observer.upper, goals + LARGEST_CORRECTION),
        )
        (load, lead), (noticed, noticed_lead), (trusted, trusted_lead) = led, self._noticed, trust
        rows = angles, goals, lowest, highest, load, noticed, trusted, lead, noticed_lead, trusted_lead
        return ObserverInputs(*(row[None] for row in rows))
