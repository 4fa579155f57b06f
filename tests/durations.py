"""Durations of test files: sums of their tests, without fixtures."""

from collections import Counter
from collections.abc import Iterable
from typing import Protocol

LISTED_FILES = 8  # number of slowest files in the summary
MIN_TESTS = 5000  # smallest number of tests in a run that prints a summary of durations


class TimedReport(Protocol):
    """Part of a pytest report with the name and duration of a test."""

    nodeid: str
    duration: float  # [s] duration of the reported phase of the test


def list_slowest_files(reports: Iterable[TimedReport]) -> list[str]:
    """Return the slowest files with their seconds, the slowest first."""
    durations: Counter[str] = Counter()
    for report in reports:
        durations[report.nodeid.partition("::")[0]] += report.duration
    return [f"{duration:.0f} s {file}" for file, duration in durations.most_common(LISTED_FILES)]
