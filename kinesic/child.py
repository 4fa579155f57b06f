"""Starts child processes: what a server, a pool of workers and a planner begin with."""

import multiprocessing
from multiprocessing.context import ForkServerContext, SpawnContext

SLOW = ("scipy.interpolate", "scipy.optimize", "scipy.spatial.transform")  # to import, and all that plans needs them


def child_context(*preload: str) -> ForkServerContext | SpawnContext:
    """Forks of a clean process where the system can, else new processes; never forks of one with threads.

    Args:
        preload: modules that forks begin with, imported once; those that the first caller names hold for all.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["__main__", *preload, *SLOW])
    return context
