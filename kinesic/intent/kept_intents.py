"""Intents in the order in which they were kept, asked all at once which of them another one would meet."""

from collections.abc import Iterable

import numpy as np

from kinesic.intent.intents import Intent

EMOTION = "emotion"  # kind of intents that have face and head for themselves while they last


class KeptIntents:
    """Intents, with their times as rows of numbers."""

    def __init__(self, intents: Iterable[Intent] = ()) -> None:
        self._intents: list[Intent] = []
        self._times = np.empty((4, 16))  # [s] starts, strokes and ends, and 1 for an emotion; a column for each
        for each in intents:
            self.add(each)

    def __len__(self) -> int:
        return len(self._intents)

    def add(self, intent: Intent) -> None:
        """Keeps one more."""
        count = len(self._intents)
        if count == self._times.shape[1]:
            self._times = np.hstack([self._times, np.empty_like(self._times)])
        seconds = (intent.start.seconds, intent.stroke.seconds, intent.end.seconds)
        self._times[:, count] = (*seconds, _is_emotion(intent))
        self._intents.append(intent)

    def reach(self, at: float, room: float) -> bool:
        """Whether a time lies within one of them, with some room before and behind [s]."""
        starts, _, ends, _ = self._times[:, : len(self._intents)]
        return bool(np.any((starts - room <= at) & (at <= ends + room)))

    def first_beside(self, intent: Intent, gap: float, *, covering: bool) -> Intent | None:
        """Finds the first one that another intent cannot be shown beside; None without one.

        Args:
            intent: the other one.
            gap: [s] least distance of strokes.
            covering: an emotion has its part of the body for itself while it lasts.
        """
        starts, strokes, ends, emotions = self._times[:, : len(self._intents)]
        met = np.abs(strokes - intent.stroke.seconds) < gap
        if covering:
            together = (starts < intent.end.seconds) & (intent.start.seconds < ends)
            met |= together if _is_emotion(intent) else together & (emotions > 0.0)
        return self._intents[int(met.argmax())] if met.any() else None


def _is_emotion(intent: Intent) -> bool:
    return intent.name.partition("-")[0] == EMOTION
