"""Return freed memory of long-lived processes to the system.

By default glibc raises its thresholds with the largest block that was ever freed, and gives every thread an arena. A
server that has once read a document of 4 MB then never returns memory, and its heap grows by fragments.
"""

import ctypes
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from threading import Thread
from time import sleep

TRIM_THRESHOLD = -1  # M_TRIM_THRESHOLD of mallopt in <malloc.h>
MMAP_THRESHOLD = -3  # M_MMAP_THRESHOLD
ARENA_MAX = -8  # M_ARENA_MAX
MAX_UNUSED_TOP = 1 << 20  # [bytes] free at the end of the heap before it is returned
MIN_MAPPED_BLOCK = 1 << 16  # [bytes] from which a block is mapped alone, and returned when it is freed
MAX_ARENAS = 2  # heaps that threads share
TRIM_PERIOD = 10.0  # [s] between two returns of free pages amid the heap, which the thresholds leave


def bound_heap() -> None:
    """Make glibc return freed memory to the system."""
    if not sys.platform.startswith("linux"):
        return
    with suppress(AttributeError, OSError):  # another C library
        configure = ctypes.CDLL(None).mallopt
        configure(ARENA_MAX, MAX_ARENAS)
        configure(MMAP_THRESHOLD, MIN_MAPPED_BLOCK)
        configure(TRIM_THRESHOLD, MAX_UNUSED_TOP)
        _start_trimming()


@cache  # one thread in each process
def _start_trimming() -> None:
    trim = ctypes.CDLL(None).malloc_trim
    Thread(target=_trim_periodically, args=(trim,), name="trim heap", daemon=True).start()


def _trim_periodically(trim: Callable[[int], int]) -> None:
    """Return free pages amid the heap to the system, again and again."""
    while True:
        sleep(TRIM_PERIOD)
        trim(0)  # takes a tenth of a millisecond, without the interpreter's lock
