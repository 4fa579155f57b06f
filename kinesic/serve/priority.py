"""Increased scheduling priority of time-critical threads."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

NORMAL_NICENESS = 0  # niceness of ordinary processes
URGENT_NICENESS = -10  # niceness for nine times the processor time of an ordinary process


@contextmanager
def raise_priority() -> Iterator[None]:
    """Raise the scheduling priority of the calling thread within the context.

    Without the right to do so, or with a niceness other than 0, the priority stays unchanged. On Linux niceness belongs
    to a thread; threads and processes that this thread starts inherit it.
    """
    granted = _has_normal_niceness() and _set_niceness(URGENT_NICENESS)
    try:
        yield
    finally:
        if granted:
            _set_niceness(NORMAL_NICENESS)


def _has_normal_niceness() -> bool:
    return sys.platform != "win32" and os.getpriority(os.PRIO_PROCESS, 0) == NORMAL_NICENESS


def _set_niceness(value: int) -> bool:
    if sys.platform != "win32":
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, 0, value)
            return True
    return False
