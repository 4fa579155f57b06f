"""Lets threads that must never wait go before other work of the machine, where the system grants it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

USUAL, URGENT = 0, -10  # niceness: ten steps are nine times the share of a contended processor


@contextmanager
def urgent() -> Iterator[None]:
    """Lets the calling thread go before ordinary processes meanwhile; who lacks the right, or used `nice`, stays as is.

    On Linux niceness is a thread's own, and whatever this thread starts meanwhile has it, too.
    """
    granted = os.getpriority(os.PRIO_PROCESS, 0) == USUAL and _set_niceness(URGENT)
    try:
        yield
    finally:
        if granted:
            _set_niceness(USUAL)


def _set_niceness(value: int) -> bool:
    try:
        os.setpriority(os.PRIO_PROCESS, 0, value)
    except OSError:
        return False
    return True
