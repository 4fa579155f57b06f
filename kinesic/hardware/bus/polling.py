"""Chooses which servos a cycle asks: the doubtful last, the silent only one by one.

In a joint reply each servo waits for the one before it, so a silent one may cut off those that stand behind it: the
first who is missing is the suspect. He is asked last of all, and after five misses no longer with the others. Then he
is asked alone whenever a cycle has time to spare, at the latest every 0.1 s, and one answer brings him back, in time or
late. So he is heard within 0.2 s, also if one answer of his is lost.
"""

import numpy as np

from kinesic.body.arrays import Flags

PATIENCE = 5  # misses in a row
MAX_POLL_INTERVAL = 0.09  # [s] after which a silent servo is asked even when there is no time


class PollingPlan:
    """The order in which servos are asked, by what they missed; by places on the bus."""

    def __init__(self, count: int) -> None:
        self.silent: Flags = np.zeros(count, dtype=np.bool_)
        self.order: tuple[int, ...] = tuple(range(count))
        self._misses = [0] * count
        self._requested = [0.0] * count  # [s] when a silent one was asked last

    @property
    def whole(self) -> bool:
        """Whether everybody is asked in the natural order."""
        return not any(self._misses)

    def note(self, fresh: Flags) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Notes who answered in a cycle, and returns who fell silent and who came back."""
        if fresh.all() and self.whole:
            return (), ()
        answered = fresh.tolist()
        self._misses = [0 if ok else misses + 1 for ok, misses in zip(answered, self._misses, strict=True)]
        once = max(self._misses) == 1 and not any(answered)  # that may be the wire, or all are late
        suspect = None if once else next((k for k in self.order if not answered[k]), None)
        silent = [misses >= PATIENCE for misses in self._misses]
        if all(silent):
            # nobody hears us: that is the wire's fault, and nobody holds up the others
            silent = self.silent.tolist()
        gone = tuple(k for k, quiet in enumerate(silent) if quiet and not self.silent[k])
        back = tuple(k for k, quiet in enumerate(silent) if not quiet and self.silent[k])
        self.silent = np.array(silent, dtype=np.bool_)
        due = [k for k, quiet in enumerate(silent) if not quiet] or range(len(silent))
        self.order = tuple(sorted(due, key=lambda k: (self._misses[k] > 0, k == suspect)))
        return gone, back

    def next_alone(self, now: float) -> tuple[int, bool] | None:
        """Returns the silent servo whose turn it is, and whether it must be asked now; None when all answer."""
        quiet = np.flatnonzero(self.silent).tolist()
        if not quiet or len(quiet) == len(self.silent):
            return None
        place: int = min(quiet, key=lambda k: self._requested[k])
        return place, now - self._requested[place] >= MAX_POLL_INTERVAL

    def note_alone(self, place: int, now: float) -> None:
        """Notes that a silent servo was asked."""
        self._requested[place] = now
