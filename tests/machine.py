"""Check whether this machine keeps time, before realtime tests.

Such a test needs timely wake-ups, a fair fraction of a core, and a core that is not much slower than those on which the
limits were set. If one of these is missing for several seconds, the test is skipped with the reason. Short disturbances
are waited for unless the previous test was skipped, too. After a failure, a longer check measures the fraction of a
core; after some such failures, the machine counts as too slow for the rest of the run.
"""

import time
from dataclasses import dataclass

import pytest

WAKE_COUNT = 12  # number of sleeps per check
SLEEP_TIME = 0.001  # [s] duration of each sleep
LOOP_COUNT = 40_000  # number of Python loop iterations per check, which take a few milliseconds
MAX_WAKE_DELAY = 0.020  # [s] acceptable delay of a wake-up
MIN_CORE_FRACTION = 0.3  # smallest fraction of a core that this process gets during a check
MAX_LOOP_TIME = 0.040  # [s] largest processor time of `LOOP_COUNT` loop iterations
CHECK_VALIDITY = 1.0  # [s] time for which a successful check is valid
PATIENCE_TIME = 6.0  # [s] duration of repeated failed checks after which the machine counts as too slow
REPEATED_PATIENCE_TIME = (
    0.1  # [s] duration of repeated failed checks, if the previous check has found the machine too slow
)
LONG_CHECK_FACTOR = 20  # factor of the loop count after a failure, so that a check exceeds a scheduler time slice
FAIR_CORE_FRACTION = 0.5  # fraction of a core below which a failed test is inconclusive
MAX_EXCUSED_FAILURES = 3  # number of inconclusive failures after which the machine counts as too slow

CODE_ERRORS = (
    AttributeError,
    FileNotFoundError,
    ImportError,
    NameError,
    TypeError,
)  # types of errors that a slow machine does not cause
WRONG_MESSAGE_TEXT = "Regex pattern did not match"  # pytest's text for an error with an unexpected message


@dataclass(frozen=True)
class Look:
    """Timing measurements of one check of the machine."""

    lateness: float  # [s] delay of the second latest wake-up
    share: float  # fraction of a core that this process got during the loops
    loops: float  # [s] processor time of the loops

    @property
    def complaint(self) -> str:
        """Reason that the machine is too slow for realtime tests, or an empty text."""
        if self.lateness > MAX_WAKE_DELAY:
            return f"it wakes {1e3 * self.lateness:.0f} ms late (at most {1e3 * MAX_WAKE_DELAY:.0f})"
        if self.share < MIN_CORE_FRACTION:
            return f"it gives {100 * self.share:.0f} % of a core (at least {100 * MIN_CORE_FRACTION:.0f})"
        if self.loops > MAX_LOOP_TIME:
            return f"a core needs {1e3 * self.loops:.0f} ms for what may take {1e3 * MAX_LOOP_TIME:.0f}"
        return ""


def look(loops: int = LOOP_COUNT) -> Look:
    """Measure wake-ups and processor time, for about 20 ms or longer."""
    late = []
    for _ in range(WAKE_COUNT):
        due = time.perf_counter() + SLEEP_TIME
        time.sleep(SLEEP_TIME)
        late.append(time.perf_counter() - due)
    wall, own = time.perf_counter(), time.thread_time()
    for _ in range(loops):
        pass
    wall, own = time.perf_counter() - wall, time.thread_time() - own
    return Look(sorted(late)[-2], own / wall, own * LOOP_COUNT / loops)


class Watch:
    """Periodic checks of the machine before realtime tests and after failures."""

    def __init__(self) -> None:
        self._good, self._patience, self._failures = -CHECK_VALIDITY, PATIENCE_TIME, 0

    def complaint(self) -> str:
        """Return why repeated checks find the machine too slow, or an empty text."""
        if self._failures == MAX_EXCUSED_FAILURES:
            return f"{MAX_EXCUSED_FAILURES} tests had too little of a core"
        began = time.monotonic()
        if began - self._good < CHECK_VALIDITY:
            return ""
        while missing := look().complaint:
            if time.monotonic() - began > self._patience:
                self._patience = REPEATED_PATIENCE_TIME
                return missing
        self._good, self._patience = time.monotonic(), PATIENCE_TIME
        return ""

    def excuse(self) -> str:
        """Return why a busy machine makes a test failure inconclusive, or an empty text."""
        self._good = -CHECK_VALIDITY
        share = look(LONG_CHECK_FACTOR * LOOP_COUNT).share
        if share >= FAIR_CORE_FRACTION:
            return ""
        self._failures = min(self._failures + 1, MAX_EXCUSED_FAILURES)
        return f"it gives {100 * share:.0f} % of a core (at least {100 * FAIR_CORE_FRACTION:.0f})"


def depends_on_time(failure: pytest.ExceptionInfo[BaseException] | None) -> bool:
    """Return whether a slow machine could have caused this failure."""
    return failure is None or not (isinstance(failure.value, CODE_ERRORS) or WRONG_MESSAGE_TEXT in str(failure.value))
