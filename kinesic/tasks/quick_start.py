"""Has workers of dask begin as forks of a process that holds what they need (`--preload-nanny`).

Others import for a second or two of CPU, and on a busy machine they are killed again before they have done anything.
"""

import dask
from distributed.utils import get_mp_context

from kinesic.child import child_context, has_private_forkserver

IMPORTED = "kinesic.report.batch"  # what most tasks import


def quick_start() -> dict[str, str]:
    """Prepares this process, and gives the settings of dask under which its nannies begin workers by forks."""
    if not has_private_forkserver():
        return {}
    method = {"distributed.worker.multiprocessing-method": "forkserver"}
    with dask.config.set(method):
        get_mp_context()  # it names modules of its own, once; ours are named after it
    child_context("distributed.nanny", "distributed.worker", IMPORTED)
    return method


def dask_setup(nanny: object) -> None:
    """Is called by `dask worker` before a nanny begins a worker."""
    dask.config.set(quick_start())
