"""Return freed memory of long-lived processes to the system.

By default glibc raises its thresholds with the largest block that was ever freed, and gives every thread an arena. A
server that has once read a document of 4 MB then never returns memory, and its heap grows by fragments.
"""

import ctypes
import sys
from contextlib import suppress

TRIM_THRESHOLD, MMAP_THRESHOLD, ARENA_MAX = -1, -3, -8  # parameters of mallopt in <malloc.h>
MAX_UNUSED_TOP = 1 << 20  # [bytes] free at the end of the heap before it is returned
MIN_MAPPED_BLOCK = 1 << 17  # [bytes] from which a block is mapped alone, and returned when it is freed
MAX_ARENAS = 2  # heaps that threads share


def bound_heap() -> None:
    """Make glibc return freed memory to the system."""
    if not sys.platform.startswith("linux"):
        return
    with suppress(AttributeError, OSError):  # another C library
        configure = ctypes.CDLL(None).mallopt
        configure(ARENA_MAX, MAX_ARENAS)
        configure(MMAP_THRESHOLD, MIN_MAPPED_BLOCK)
        configure(TRIM_THRESHOLD, MAX_UNUSED_TOP)
