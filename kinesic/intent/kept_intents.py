"""Vectorised search for conflicts with the intents chosen before."""

from collections.abc import Iterable

import numpy as np

from kinesic.intent.intents import Intent

EMOTION_CATEGORY = "emotion"  # category of intents that exclude others on face and head


class KeptIntents:
    """Chosen intents, with their times in an array for fast search."""

    def __init__(self, intents: Iterable[Intent] = ()) -> None:
        self._intents: list[Intent] = []
        self._times = np.empty((4, 16))  # rows: start, stroke, end [s], and 1 for an emotion; one column per intent
        for intent in intents:
            self.add(intent)

    def __len__(self) -> int:
        return len(self._intents)

    def add(self, intent: Intent) -> None:
        """Add an intent to the kept intents and their times."""
        count = len(self._intents)
        if count == self._times.shape[1]:
            self._times = np.hstack([self._times, np.empty_like(self._times)])
        seconds = (intent.start.seconds, intent.stroke.seconds, intent.end.seconds)
        self._times[:, count] = (*seconds, _is_emotion(intent))
        self._intents.append(intent)

    def covers(self, at: float, margin: float) -> bool:
        """Return whether a chosen intent spans a time, with a margin [s]."""
        starts, _, ends, _ = self._times[:, : len(self._intents)]
        return bool(np.any((starts - margin <= at) & (at <= ends + margin)))

    def first_conflict(self, intent: Intent, gap: float, *, covering: bool) -> Intent | None:
        """Return the first chosen intent that conflicts with a new one.

        Args:
            intent: the new one.
            gap: smallest spacing of strokes [s].
            covering: whether an emotion excludes others on its channel while it lasts.

        Returns:
            None without a conflict.
        """
        starts, strokes, ends, emotions = self._times[:, : len(self._intents)]
        conflicts = np.abs(strokes - intent.stroke.seconds) < gap
        if covering:
            together = (starts < intent.end.seconds) & (intent.start.seconds < ends)
            conflicts |= together if _is_emotion(intent) else together & (emotions > 0.0)
        return self._intents[int(conflicts.argmax())] if conflicts.any() else None


def _is_emotion(intent: Intent) -> bool:
    return intent.name.partition("-")[0] == EMOTION_CATEGORY
