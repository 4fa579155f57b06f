"""Test files that each process imports, in a run of the whole suite.

Importing all tests takes ten seconds of a processor. Two processes (`CLOCK_WORKERS`) run tests that mostly wait, in a
browser or in real time, and import only these files. The other, calculating processes together import all files: each
imports files of its own, and the same shared files as the others. It runs its own first, so that the shared ones let
all processes end together. `scheduling.py` chooses which process runs a file.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest

from .scheduling import CLOCK_WORKERS, kind_of

OWN_FRACTION = 0.7  # fraction of the test code [bytes] that only one calculating process imports


def find_omitted_files(config: pytest.Config, worker: str, count: int) -> list[str]:
    """Return the names of the test files that a process does not import.

    Args:
        config: configuration of the process that starts the others.
        worker: name of the process.
        count: number of test processes, including those for waiting tests.

    Returns:
        Empty for a run of selected files, without calculating processes, or in place of a crashed process.
    """
    calculating = count - len(CLOCK_WORKERS)
    if config.args_source is not pytest.Config.ArgsSource.TESTPATHS or calculating < 1:
        return []
    root = config.rootpath
    files = list_test_files(root)
    if worker in CLOCK_WORKERS:
        return [file for file in files if kind_of(file, root) == "calculation"]
    number = int(worker.removeprefix("gw")) - len(CLOCK_WORKERS)
    if number >= calculating:
        return []  # replaces a crashed process, so may need any of its files
    return [file for file, owner in assign_owners(files, calculating).items() if owner not in (number, None)]


@cache
def list_test_files(root: Path) -> dict[str, int]:
    """Return the sizes [bytes] of all test files, in alphabetical order."""
    files = sorted((root / "tests").rglob("test_*.py"))
    return {file.relative_to(root).as_posix(): file.stat().st_size for file in files}


def assign_owners(files: Mapping[str, int], count: int) -> dict[str, int | None]:
    """Assign each file to one calculating process, or to all of them (None).

    The files are cut into `count` runs of equal size. The beginning of a run belongs to one process, so that it imports
    few packages, and the end to all.

    Args:
        files: sizes [bytes] of the files, in alphabetical order.
        count: number of calculating processes.
    """
    owners: dict[str, int | None] = {}
    total, before = sum(files.values()), 0
    for file, size in files.items():
        owner, offset = divmod(count * before / total, 1)
        owners[file] = int(owner) if offset < OWN_FRACTION else None
        before += size
    return owners
