"""Test files that each process imports."""

from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import pytest

from .partition import OWN_FRACTION, assign_owners, find_omitted_files, list_test_files

ROOT = Path(__file__).parents[1]
WHOLE, PART = (
    SimpleNamespace(args_source=source, rootpath=ROOT)
    for source in (pytest.Config.ArgsSource.TESTPATHS, pytest.Config.ArgsSource.ARGS)
)


def collected(worker: str, count: int) -> set[str]:
    return set(list_test_files(ROOT)).difference(find_omitted_files(WHOLE, worker, count))


@pytest.mark.parametrize("count", [3, 4, 10])
def test_calculating_test_processes_together_import_all_files_and_share_a_third_of_the_code(count: int):
    parts = [collected(f"gw{k}", count) for k in range(2, count)]
    assert set().union(*parts) == set(list_test_files(ROOT))
    times = Counter(file for part in parts for file in part)
    assert set(times.values()) <= {1, count - 2}
    sizes = list_test_files(ROOT)
    own = sum(size for file, size in sizes.items() if times[file] == 1) / sum(sizes.values())
    assert own == pytest.approx(OWN_FRACTION if count > 3 else 1.0, abs=0.02)


def test_first_two_test_processes_import_only_browser_and_realtime_tests():
    waiting = [collected(f"gw{k}", 4) for k in (0, 1)]
    assert waiting[0] == waiting[1]
    assert {"tests/studio/test_page.py", "tests/mcp/test_stop.py"} <= waiting[0]
    assert "tests/test_partition.py" not in waiting[0]


@pytest.mark.parametrize(("worker", "count"), [("gw4", 4), ("gw9", 4), ("gw0", 2), ("gw1", 2)])
def test_test_processes_that_replace_crashed_ones_or_are_only_two_import_all_test_files(worker: str, count: int):
    assert find_omitted_files(WHOLE, worker, count) == []


def test_all_test_processes_import_the_test_files_named_in_the_command():
    assert not any(find_omitted_files(PART, f"gw{k}", 4) for k in range(4))


def test_each_test_process_owns_successive_test_files():
    owners = assign_owners({f"test_{k}": 1 for k in range(20)}, 2)
    assert list(owners.values()) == [*[0] * 7, *[None] * 3, *[1] * 7, *[None] * 3]
