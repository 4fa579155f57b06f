"""Free space of a pipe to another process."""

import select
import sys

from kinesic.child import PipeEnd


def has_space(pipe: PipeEnd) -> bool:
    """Return whether a message of some kB can be sent without blocking.

    Always true on Windows.
    """
    is_free = True
    if sys.platform != "win32":
        poller = select.poll()
        poller.register(pipe, select.POLLOUT)  # Linux reports it if at least three quarters of the buffer are free
        is_free = bool(poller.poll(0))
    return is_free
