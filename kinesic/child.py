"""Child processes: how a server, a pool of workers and a window begin, watch and end theirs."""

import gc
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import current_process, parent_process
from pathlib import Path
from threading import Thread
from typing import TypeVarTuple

from kinesic.heap import bound_heap

SLOW = (  # to import: plans need the first three where times move, and the last where a word means no gesture
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.spatial.transform",
    "kinesic.expressivity.lexicon.read_ahead",
)

NAME_FILE = Path("/proc/self/comm")  # Linux only
ORPHANED = 1  # the exit code of a child whose parent has gone

Arguments = TypeVarTuple("Arguments")


def has_private_forkserver() -> bool:
    """Return True if only this user can reach the server of forks."""
    # Python 3.11.0 lets all users connect to it, and have it run code (CVE-2022-42919).
    return "forkserver" in multiprocessing.get_all_start_methods() and sys.version_info[:3] >= (3, 11, 1)


def child_context(*preload: str) -> ForkServerContext | SpawnContext:
    """Chooses how processes begin: as forks of a clean one where the system can, never of one with threads.

    Args:
        preload: modules that forks begin with, imported once; those that the first caller names hold for all.
    """
    if not has_private_forkserver():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["__main__", *preload, *SLOW])
    return context


class Child:
    """A process that does one thing, and ends at the latest with the one that began it.

    Ctrl-C in a terminal, its closing, and other signals to a whole group of processes are for that one alone.
    """

    def __init__(
        self,
        context: ForkServerContext | SpawnContext,
        work: Callable[[*Arguments], None],
        *arguments: *Arguments,
        name: str | None = None,
    ) -> None:
        """Begins the process.

        Args:
            context: how processes begin, such as `child_context()`.
            work: called in the process.
            arguments: of the work, picklable. An end of a pipe belongs to the process from now on: it is closed here,
                so that our end is told when the process dies.
            name: in lists of processes.
        """
        self._process = context.Process(target=_work_apart, args=(work, *arguments), name=name, daemon=True)
        _begin_forks(context)
        self._process.start()
        for argument in arguments:
            if isinstance(argument, Connection):
                argument.close()

    @property
    def is_alive(self) -> bool:
        """Whether it has not ended."""
        return self._process.is_alive()

    def wait(self, seconds: float | None = None) -> int | None:
        """Waits until it ends, or for some time [s]; its exit code, negative for a signal, and None while it lives."""
        self._process.join(seconds)
        return self._process.exitcode

    def kill(self, *, wait: bool = True) -> None:
        """Ends it at once.

        Args:
            wait: until it has ended, which takes some milliseconds.
        """
        self._process.kill()
        if wait:
            self._process.join()


def _begin_forks(context: ForkServerContext | SpawnContext) -> None:
    """Start the forkserver with Ctrl-C blocked, also during its imports."""
    if isinstance(context, ForkServerContext):
        resource_tracker.ensure_running()  # first: it unblocks the signal
        usual = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            forkserver.ensure_running()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, usual)


def _work_apart(work: Callable[[*Arguments], None], *arguments: *Arguments) -> None:
    """Works in a group of its own, which no terminal signals, and ends with its parent whatever it is doing."""
    os.setpgid(0, 0)
    bound_heap()
    gc.freeze()  # what was preloaded: marking it would copy every page that forks share
    _show_name(current_process().name)
    Thread(target=_end_with_parent, name="end with parent", daemon=True).start()
    work(*arguments)


def _show_name(name: str) -> None:
    """Show the name of this process in lists, such as `top`."""
    with suppress(OSError):  # another system
        NAME_FILE.write_text(name)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(ORPHANED)  # not by an exception: the work is another thread's
