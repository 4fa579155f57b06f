"""Fast start of dask workers as forks of a prepared process.

It is used through `--preload-nanny`. Other workers import for one or two seconds of CPU, and on a busy machine they
are killed before they have done anything.
"""

import dask
from distributed.utils import get_mp_context

from kinesic.child import child_context, has_private_forkserver

PRELOADED_MODULE = "kinesic.report.batch"  # imported before workers are forked, since most tasks need it


def quick_start() -> dict[str, str]:
    """Prepare this process and return dask settings that fork workers.

    The settings are empty on systems without a private fork server.
    """
    if not has_private_forkserver():
        return {}
    method = {"distributed.worker.multiprocessing-method": "forkserver"}
    with dask.config.set(method):
        get_mp_context()  # it sets its own modules once, before ours are added
    child_context("distributed.nanny", "distributed.worker", PRELOADED_MODULE)
    return method


def dask_setup(nanny: object) -> None:
    """Apply fast-start settings before a nanny of `dask worker` starts a worker."""
    dask.config.set(quick_start())
