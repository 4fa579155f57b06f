"""The bench of the studio, with a server of its own."""

import pytest

from kinesic.bench import studio
from kinesic.bench.bml.server import open_server
from kinesic.client import Client

pytestmark = pytest.mark.realtime


def test_edits_dragged_hands_and_watching_are_measured_and_nothing_that_is_wrong(monkeypatch):
    monkeypatch.setattr(studio, "ROBOT", "upper22")
    with open_server("--voice", "durations") as server, Client(port=server.port) as client:
        edits, reaches = studio.time_edits(client, 2), studio.time_reaches(client, 5)
        assert (len(edits), len(reaches)) == (2, 5)
        assert min(edits) > min(reaches) > 0.0
        share = studio.watching_share(server, client, 0.5)
        assert share is None or 0.0 <= share < 100.0
        monkeypatch.setattr(studio, "EDITED", "<bml")
        with pytest.raises(RuntimeError, match="not XML"):
            studio.time_edits(client, 1)


def test_a_browser_loads_little():
    assert 1.0 < studio.bundle_size() < studio.BUNDLE
