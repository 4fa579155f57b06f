"""Return of freed memory to the system, and short garbage collections.

By default glibc raises its thresholds with the largest block that was ever freed, and gives every thread an arena. A
server that has once read a document of 4 MB then never returns memory, and its heap grows by fragments.
"""

import ctypes
import gc
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from threading import Thread
from time import sleep

TRIM_THRESHOLD = -1  # number of mallopt's parameter M_TRIM_THRESHOLD in <malloc.h>
MMAP_THRESHOLD = -3  # number of mallopt's parameter M_MMAP_THRESHOLD in <malloc.h>
ARENA_MAX = -8  # number of mallopt's parameter M_ARENA_MAX in <malloc.h>
MAX_UNUSED_TOP = 1 << 20  # [bytes] largest free memory at the heap end, above which it is returned
MIN_MAPPED_BLOCK = 1 << 17  # [bytes] smallest block that is mapped separately and returned when freed
MAX_ARENAS = 2  # largest number of heaps, which all threads share
TRIM_PERIOD = 10.0  # [s] time between two returns of free pages within the heap to the system


def freeze_heap() -> None:
    """Exclude all existing objects from later garbage collections.

    A collection holds the interpreter's lock, and would take a third of a second for the modules and data of a server:
    control ticks and emergency stops would wait for it.
    """
    gc.freeze()


def bound_heap() -> None:
    """Make glibc return freed memory to the system.

    Other C libraries stay unchanged.
    """
    if sys.platform == "linux":
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
    """Give free heap pages back to the system periodically."""
    while True:
        sleep(TRIM_PERIOD)
        trim(0)  # takes a tenth of a millisecond, without the interpreter's lock
