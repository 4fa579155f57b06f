"""Real time, where the host grants it: what must not be late goes before everything else on the machine."""

import os
import sys


def request_real_time(priority: int) -> bool:
    """Asks the host for real time for this process; whether it grants it.

    Args:
        priority: of SCHED_FIFO, 1..99.
    """
    if sys.platform != "linux":
        return False
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError:
        return False
    return True
