"""Live server of the benchmarks, started once in each test process."""

from collections.abc import Iterator

import pytest

from kinesic.bench.bml.emergency_stop import WatchedServer, watched_server


@pytest.fixture(scope="session")
def recorded_server() -> Iterator[WatchedServer]:
    """Server that records its servo goals, for all files of this folder."""
    with watched_server() as running:
        yield running
