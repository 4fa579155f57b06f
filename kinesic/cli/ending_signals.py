"""Signals that end a command: what it has begun is put away, and a terminal that has closed is used no more."""

import os
import select
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

STOPPED = 130  # the exit code of Ctrl-C
STOPPED_LINE = "kinesic: stopped"


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Lets SIGTERM and a terminal that closes end what is done meanwhile as an exception would, not on the spot.

    One that is ignored, as under nohup, stays so. Outside the main thread, which alone hears them, nothing changes.

    Raises:
        SystemExit: one came; its code is that of a shell, 128 and the signal's number.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    usual = [each for each in (signal.SIGTERM, signal.SIGHUP) if signal.getsignal(each) is signal.SIG_DFL]
    for number in usual:
        signal.signal(number, _end)
    try:
        yield
    finally:
        for number in usual:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def ended_on_the_spot() -> Iterator[None]:
    """Lets Ctrl-C end the process at once while modules are imported, which may swallow it; nothing is made by then."""
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or usual is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _vanish)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)


def _vanish(_number: int, _frame: FrameType | None) -> None:
    os.write(2, f"{STOPPED_LINE}\n".encode())
    os._exit(STOPPED)


def _end(number: int, _frame: FrameType | None) -> None:
    leave_closed_terminal()
    sys.exit(128 + number)


def leave_closed_terminal() -> None:
    """Lets what would still be read from or written to a terminal that has closed come from nowhere and go there."""
    looking = select.poll()
    for stream in range(3):
        looking.register(stream, select.POLLHUP)
    closed = [stream for stream, event in looking.poll(0) if event & select.POLLHUP]
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in closed:
        os.dup2(nowhere, stream)
    os.close(nowhere)
