"""Benchmark of the studio with its own server."""

import pytest

from kinesic.bench import studio
from kinesic.bench.bml.server import open_server
from kinesic.client import Client

pytestmark = pytest.mark.realtime


@pytest.mark.soak
def test_studio_benchmark_times_edits_and_drags_and_raises_server_errors(monkeypatch):
    monkeypatch.setattr(studio, "BENCH_ROBOT", "upper22")
    with open_server("--voice", "durations") as server, Client(port=server.port) as client:
        edits, reaches = studio.time_edits(client, 2), studio.time_reaches(client, 5)
        assert (len(edits), len(reaches)) == (2, 5)
        assert min(edits) > min(reaches) > 0.0
        load = studio.watching_load(server, client, 0.5)
        assert load is None or 0.0 <= load < 100.0
        monkeypatch.setattr(studio, "EDITED_BLOCK", "<bml")
        with pytest.raises(RuntimeError, match="not XML"):
            studio.time_edits(client, 1)


def test_browser_bundle_is_below_its_size_limit():
    assert 1.0 < studio.bundle_size() < studio.MAX_BUNDLE_SIZE
