"""Whether this machine keeps time at the moment: what a test in real time asks before it begins.

Such a test needs to be woken when it asked to be, a fair share of a core, and a core that is not far slower than those
on which the limits of tests were found. Where one of these is missing for several seconds, the test says so and is
skipped; a short disturbance is waited for, unless the last test was skipped as well. Where a test failed, a longer look
says whether it lacked a core; after some such failures the machine is called too slow to the end, so that a run ends.
"""

import time
from dataclasses import dataclass

WAKES, NAP = 12, 0.001  # sleeps of one look, [s] each
LOOPS = 40_000  # of plain Python: a few milliseconds
LATEST = 0.020  # [s] that a wake-up may come late
LEAST_SHARE = 0.3  # of a core
SLOWEST = 0.040  # [s] of processor for the loops
GOOD_FOR = 1.0  # [s] that a good look counts
PATIENCE, AGAIN = 6.0, 0.1  # [s] until the machine is called too slow, and where it was so before the last test
LONGER = 20  # times the loops after a failure: more than a process may go on calculating while others wait
FAIR_SHARE = 0.5  # of a core, without which a failure tells nothing
FAILURES = 3  # without it, after which nobody tries again


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


def look(loops: int = LOOPS) -> Look:
    """Measures wake-ups and the processor, for some 20 ms or longer."""
    late = []
    for _ in range(WAKES):
        due = time.perf_counter() + NAP
        time.sleep(NAP)
        late.append(time.perf_counter() - due)
    wall, own = time.perf_counter(), time.thread_time()
    for _ in range(loops):
        pass
    wall, own = time.perf_counter() - wall, time.thread_time() - own
    return Look(sorted(late)[-2], own / wall, own * LOOPS / loops)


class Watch:
    """Looks at the machine before tests in real time, at most once a second while it keeps time, and after failures."""

    def __init__(self) -> None:
        self._good, self._patience, self._failures = -GOOD_FOR, PATIENCE, 0

    def complaint(self) -> str:
        """Why time cannot be kept here, after some patience; nothing where it can."""
        if self._failures == FAILURES:
            return f"{FAILURES} tests had too little of a core"
        began = time.monotonic()
        if began - self._good < GOOD_FOR:
            return ""
        while missing := look().complaint:
            if time.monotonic() - began > self._patience:
                self._patience = AGAIN
                return missing
        self._good, self._patience = time.monotonic(), PATIENCE
        return ""

    def excuse(self) -> str:
        """Why a test that has just failed tells nothing; nothing where it had what it needs."""
        self._good = -GOOD_FOR
        share = look(LONGER * LOOPS).share
        if share >= FAIR_SHARE:
            return ""
        self._failures = min(self._failures + 1, FAILURES)
        return f"it gives {100 * share:.0f} % of a core (at least {100 * FAIR_SHARE:.0f})"
