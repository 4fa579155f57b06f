"""Handlers that end a command cleanly on SIGTERM, SIGHUP or Ctrl-C.

Temporary results are removed, and a closed terminal is no longer used. The command line imports this module first:
it imports nothing slow, so that Ctrl-C prints one line from the beginning.
"""

import os
import select
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

EXIT_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)
)  # signals that end a process, except SIGINT (Ctrl-C)
INTERRUPTED_EXIT_CODE = 130  # 128 plus the number of SIGINT
INTERRUPTED_MESSAGE = "kinesic: stopped"


@contextmanager
def exit_on_signals() -> Iterator[None]:
    """Turn SIGTERM and SIGHUP into exceptions, so that cleanup code runs.

    Signals that are ignored, as under nohup, stay ignored. Outside the main thread, which alone receives signals,
    nothing changes.

    Raises:
        SystemExit: a signal arrived; the exit code is that of a shell, 128 plus the signal number.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    default_signals = [number for number in EXIT_SIGNALS if signal.getsignal(number) is signal.SIG_DFL]
    for number in default_signals:
        signal.signal(number, _exit_for_signal)
    try:
        yield
    finally:
        for number in default_signals:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def exit_at_once_on_interrupt() -> Iterator[None]:
    """Make Ctrl-C end the process at once while modules are imported.

    Import code may swallow KeyboardInterrupt. Nothing has been written at this point, so no cleanup is needed.
    """
    previous_handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or previous_handler is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _exit_at_once)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous_handler)


def _exit_at_once(_number: int, _frame: FrameType | None) -> None:
    os.write(2, f"{INTERRUPTED_MESSAGE}\n".encode())
    os._exit(INTERRUPTED_EXIT_CODE)


def _exit_for_signal(number: int, _frame: FrameType | None) -> None:
    detach_closed_terminal()
    sys.exit(128 + number)


def detach_closed_terminal() -> None:
    """Redirect the standard streams of a closed terminal to /dev/null."""
    if sys.platform != "win32":  # Windows ends the programs of a closed console
        poller = select.poll()
        for stream in range(3):
            poller.register(stream, select.POLLHUP)
        closed = [stream for stream, event in poller.poll(0) if event & select.POLLHUP]
        null_device = os.open(os.devnull, os.O_RDWR)
        for stream in closed:
            os.dup2(null_device, stream)
        os.close(null_device)
