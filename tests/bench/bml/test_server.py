"""The bench of the live server, with a server of its own: a sample of what `make soak` runs for long."""

import pytest

from kinesic.bench.bml import server as live_server
from kinesic.bench.bml.server import FLAT, RATE, SMALL, _grown, endurance, latencies, open_server

pytestmark = pytest.mark.realtime

SECONDS = 3.0


@pytest.fixture(scope="module")
def server():
    with open_server("--voice", "durations") as found:
        yield found


def test_every_block_is_measured(server, monkeypatch):
    monkeypatch.setattr(live_server, "EVERY", 0.5)
    found = latencies(server, len(SMALL))
    assert len(found) == len(SMALL)
    assert all(0.0 < each.feedback <= each.command for each in found)


def test_ten_blocks_a_second_lose_nothing_and_memory_stays(server):
    lasting = endurance(server, SECONDS)
    assert lasting.sent == SECONDS * RATE
    assert lasting.lost == 0
    assert lasting.growth is None or lasting.growth <= FLAT


def test_a_server_that_does_not_open_says_why():
    with (
        pytest.raises(RuntimeError, match="did not open: kinesic: --rule rate=x"),
        open_server("--rule", "rate=x"),
    ):
        pass


def test_growth_is_from_the_settled_part_to_the_end():
    memory = [(float(k), 100 if k < 5 else 200 if k < 15 else 210) for k in range(20)]
    assert _grown(memory, 20.0) == pytest.approx(5.0)
    assert _grown([], 20.0) is None
