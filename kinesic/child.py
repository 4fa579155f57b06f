"""Child processes that end with their parent."""

import gc
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import wait
from multiprocessing.context import SpawnContext
from multiprocessing.process import current_process, parent_process
from pathlib import Path
from threading import Thread
from typing import TypeVarTuple

from kinesic.heap import bound_heap

if sys.platform != "win32":
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkServerContext

    PipeEnd = Connection
    ProcessContext = ForkServerContext | SpawnContext
else:
    from multiprocessing.connection import PipeConnection

    PipeEnd = PipeConnection
    ProcessContext = SpawnContext

SLOW_IMPORTS = (  # modules that the fork server also preloads: linear program solver, gesture search
    "highspy",
    "kinesic.expressivity.lexicon.read_ahead",
)

PROCESS_NAME_FILE = Path("/proc/self/comm")  # file with the name of this process, on Linux only
ORPHAN_EXIT_CODE = 1  # exit code of a child whose parent has ended

Arguments = TypeVarTuple("Arguments")


def has_private_forkserver() -> bool:
    """Return whether Python has a fork server private to this user."""
    # In Python 3.11.0 all users can connect to it and run code (CVE-2022-42919).
    return "forkserver" in multiprocessing.get_all_start_methods() and sys.version_info[:3] >= (3, 11, 1)


def child_context(*preload: str) -> ProcessContext:
    """Return a multiprocessing context that never forks a multi-threaded process.

    It uses a fork server where available, else new processes.

    Args:
        preload: modules imported once by the fork server; only the first call of a program has an effect.
    """
    if sys.platform != "win32" and has_private_forkserver():
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(["__main__", *preload, *SLOW_IMPORTS])
        return context
    return multiprocessing.get_context("spawn")


class Child:
    """Child process that ends with its parent at the latest.

    Ctrl-C and other signals to the terminal's process group reach only the parent.
    """

    def __init__(
        self,
        context: ProcessContext,
        work: Callable[[*Arguments], None],
        *arguments: *Arguments,
        name: str | None = None,
    ) -> None:
        """Start the process.

        Args:
            context: multiprocessing context, such as `child_context()`.
            work: function called in the process.
            arguments: arguments of the function, picklable. A pipe end is closed in this process, so that the other end
                is notified when the child dies.
            name: name in process lists.
        """
        self._process = context.Process(target=_work_apart, args=(work, *arguments), name=name, daemon=True)
        _begin_forks(context)
        self._process.start()
        for argument in arguments:
            if isinstance(argument, PipeEnd):
                argument.close()

    @property
    def is_alive(self) -> bool:
        """Whether the process has not ended."""
        return self._process.is_alive()

    def wait(self, seconds: float | None = None) -> int | None:
        """Wait until the process ends, at most for a timeout [s].

        Returns:
            The exit code, negative for a signal; None while the process runs.
        """
        self._process.join(seconds)
        return self._process.exitcode

    def kill(self, *, wait: bool = True) -> None:
        """Kill the process.

        Args:
            wait: whether to wait until it has ended, which takes some milliseconds.
        """
        self._process.kill()
        if wait:
            self._process.join()


def _begin_forks(context: ProcessContext) -> None:
    """Start the context's fork server, if any, with SIGINT blocked."""
    if sys.platform != "win32" and isinstance(context, ForkServerContext):
        from multiprocessing import forkserver, resource_tracker  # noqa: PLC0415 - Windows has none

        resource_tracker.ensure_running()  # before blocking, because it unblocks the signal
        usual = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            forkserver.ensure_running()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, usual)


def _work_apart(work: Callable[[*Arguments], None], *arguments: *Arguments) -> None:
    """Run the child's function in a separate process group.

    Terminal signals do not reach this group. The process ends with its parent.
    """
    if sys.platform != "win32":
        os.setpgid(0, 0)
    bound_heap()
    gc.freeze()  # otherwise a collection would copy the preloaded pages that forks share
    _show_name(current_process().name)
    Thread(target=_end_with_parent, name="end with parent", daemon=True).start()
    work(*arguments)


def _show_name(name: str) -> None:
    """Set the name of this process in process lists, on Linux only."""
    with suppress(OSError):  # not on Linux
        PROCESS_NAME_FILE.write_text(name)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(ORPHAN_EXIT_CODE)  # an exception would not end the work, which runs in another thread
