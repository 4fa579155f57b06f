"""Durations of test files in the summary of a run."""

from types import SimpleNamespace

from .durations import LISTED_FILES, list_slowest_files


def test_duration_summary_sorts_test_files_by_the_sum_of_their_test_durations():
    durations = {"a.py::test_one": 2.0, "b.py::test_two[x]": 1.5, "b.py::test_two[y]": 1.4}
    reports = [SimpleNamespace(nodeid=name, duration=duration) for name, duration in durations.items()]
    assert list_slowest_files(reports) == ["3 s b.py", "2 s a.py"]


def test_duration_summary_lists_only_the_slowest_test_files():
    reports = [SimpleNamespace(nodeid=f"{number}.py::test", duration=number) for number in range(20)]
    assert len(list_slowest_files(reports)) == LISTED_FILES
