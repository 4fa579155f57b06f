"""Choice of the servos that a cycle queries.

In a common reply each servo waits for the one before it, so a silent servo may cut off the servos after it. The first
missing servo is therefore suspect and is queried last. After five misses it is excluded from the joint query. It is
then queried alone whenever a cycle has spare time, at the latest every 0.1 s, and one reply, in time or late, ends the
exclusion. So a servo that answers again is heard within 0.2 s, even if one of its replies is lost.
"""

import numpy as np

from kinesic.body.arrays import Flags

MAX_MISSES = 5  # number of successive missed replies after which a servo is queried alone
MAX_POLL_INTERVAL = 0.09  # [s] longest interval between queries of a silent servo, even without spare time


class PollingPlan:
    """Query order of a bus: servos whose replies were missing come last."""

    def __init__(self, count: int) -> None:
        self.silent: Flags = np.zeros(count, dtype=np.bool_)
        self.order: tuple[int, ...] = tuple(range(count))
        self._misses = [0] * count
        self._requested = [0.0] * count  # [s] time of the last query of each silent servo

    @property
    def is_natural(self) -> bool:
        """Whether all last replies arrived, so that bus order applies."""
        return not any(self._misses)

    def note(self, fresh: Flags) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Update the silent servos from the replies of a cycle.

        Returns newly silent servos, and servos that answer again.
        """
        if fresh.all() and self.is_natural:
            return (), ()
        answered = fresh.tolist()
        self._misses = [0 if ok else misses + 1 for ok, misses in zip(answered, self._misses, strict=True)]
        once = max(self._misses) == 1 and not any(answered)  # the wire may have failed, or all replies are late
        suspect = None if once else next((k for k in self.order if not answered[k]), None)
        silent = [misses >= MAX_MISSES for misses in self._misses]
        if all(silent):
            # if no servo answers, the wire has failed and no servo delays the others
            silent = self.silent.tolist()
        gone = tuple(k for k, quiet in enumerate(silent) if quiet and not self.silent[k])
        back = tuple(k for k, quiet in enumerate(silent) if not quiet and self.silent[k])
        self.silent = np.array(silent, dtype=np.bool_)
        due = [k for k, quiet in enumerate(silent) if not quiet] or range(len(silent))
        self.order = tuple(sorted(due, key=lambda k: (self._misses[k] > 0, k == suspect)))
        return gone, back

    def next_alone(self, now: float) -> tuple[int, bool] | None:
        """Return the silent servo to query next, and whether it is due.

        None if all servos answer, or none does.
        """
        quiet = np.flatnonzero(self.silent).tolist()
        if not quiet or len(quiet) == len(self.silent):
            return None
        place: int = min(quiet, key=lambda k: self._requested[k])
        return place, now - self._requested[place] >= MAX_POLL_INTERVAL

    def note_alone(self, place: int, now: float) -> None:
        """Record the time of a separate query of a silent servo."""
        self._requested[place] = now
