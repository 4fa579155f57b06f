"""Test files that each process imports, in a run of the whole suite.

Importing all tests takes ten seconds of a processor. The processes for waiting tests therefore import only these tests.
Each calculating process imports files of its own, and a part of the files that all calculating processes share. These
even out differences: a process that is done with its own files continues with shared ones.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest

from .scheduling import CLOCK_WORKERS, kind_of

OWN_FRACTION = 0.7  # fraction of the test code [bytes] that belongs to one calculating process; the rest is shared


def find_omitted_files(config: pytest.Config, worker: str, count: int) -> list[str]:
    """Return the names of the test files that a process does not import.

    Args:
        config: configuration of the process that starts the others.
        worker: name of the process.
        count: number of processes.
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
        return []  # replaces a crashed process, whose files it does not know
    return [file for file, owner in assign_owners(files, calculating).items() if owner not in (number, None)]


@cache
def list_test_files(root: Path) -> dict[str, int]:
    """Return the sizes [bytes] of all test files, in alphabetical order."""
    files = sorted((root / "tests").rglob("test_*.py"))
    return {file.relative_to(root).as_posix(): file.stat().st_size for file in files}


def assign_owners(files: Mapping[str, int], count: int) -> dict[str, int | None]:
    """Assign each file to one of several processes, or to all of them (None).

    The files of a process follow each other, so that it imports few packages.

    Args:
        files: sizes [bytes] of the files, in alphabetical order.
        count: number of processes.
    """
    owners: dict[str, int | None] = {}
    total, before = sum(files.values()), 0
    for file, size in files.items():
        owner, offset = divmod(count * before / total, 1)
        owners[file] = int(owner) if offset < OWN_FRACTION else None
        before += size
    return owners
