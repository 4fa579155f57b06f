"""Whether this machine keeps time at the moment: what a test in real time asks before it begins.

Such a test needs to be woken when it asked to be, a fair share of a core, and a core that is not far slower than those
on which the limits of tests were found. Where one of these is missing for several seconds, the test says so and is
skipped; a short disturbance is waited for.
"""

import time
from dataclasses import dataclass

WAKES, NAP = 12, 0.001  # sleeps of one look, [s] each
LOOPS = 40_000  # of plain Python: a few milliseconds
LATEST = 0.020  # [s] that a wake-up may come late
LEAST_SHARE = 0.3  # of a core
SLOWEST = 0.040  # [s] of processor for the loops
GOOD_FOR = 1.0  # [s] that a good look counts
PATIENCE = 6.0  # [s] until the machine is called too slow


@dataclass(frozen=True)
class Look:
    """What one look at the machine found."""

    lateness: float  # [s] of the second worst wake-up
    share: float  # of a core that this process got while it calculated
    loops: float  # [s] of processor that the loops took

    @property
    def complaint(self) -> str:
        """What is missing; nothing where time can be kept."""
        if self.lateness > LATEST:
            return f"it wakes {1e3 * self.lateness:.0f} ms late (at most {1e3 * LATEST:.0f})"
        if self.share < LEAST_SHARE:
            return f"it gives {100 * self.share:.0f} % of a core (at least {100 * LEAST_SHARE:.0f})"
        if self.loops > SLOWEST:
            return f"a core needs {1e3 * self.loops:.0f} ms for what may take {1e3 * SLOWEST:.0f}"
        return ""


def look() -> Look:
    """Measures wake-ups and the processor for some 20 ms."""
    late = []
    for _ in range(WAKES):
        due = time.perf_counter() + NAP
        time.sleep(NAP)
        late.append(time.perf_counter() - due)
    wall, own = time.perf_counter(), time.thread_time()
    for _ in range(LOOPS):
        pass
    wall, own = time.perf_counter() - wall, time.thread_time() - own
    return Look(sorted(late)[-2], own / wall, own)


class Watch:
    """Looks at the machine before tests in real time, at most once a second while it keeps time."""

    def __init__(self) -> None:
        self._good = -GOOD_FOR

    def complaint(self) -> str:
        """Why time cannot be kept here, after some patience; nothing where it can."""
        began = time.monotonic()
        if began - self._good < GOOD_FOR:
            return ""
        while missing := look().complaint:
            if time.monotonic() - began > PATIENCE:
                return missing
        self._good = time.monotonic()
        return ""
