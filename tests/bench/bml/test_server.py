"""Benchmark of the live server, with shorter runs than in `make soak`."""

import pytest

from kinesic.bench.bml import server as live_server
from kinesic.bench.bml.server import (
    ENDURANCE_RATE,
    MAX_MEMORY_GROWTH,
    SMALL_BEHAVIOURS,
    _compute_memory_growth,
    measure_latencies,
    open_server,
    run_endurance,
)

pytestmark = pytest.mark.realtime

ENDURANCE_SECONDS = 1.5  # [s] duration of the endurance run


@pytest.fixture(scope="module")
def server():
    with open_server("--voice", "durations") as running:
        yield running


def test_server_benchmark_measures_feedback_and_command_latency_of_each_block(server, monkeypatch):
    monkeypatch.setattr(live_server, "BLOCK_INTERVAL", 0.5)
    delays = measure_latencies(server, len(SMALL_BEHAVIOURS))
    assert len(delays) == len(SMALL_BEHAVIOURS)
    assert all(0.0 < delay.feedback <= delay.command for delay in delays)


@pytest.mark.soak
def test_server_loses_no_block_and_bounds_memory_growth_at_ten_blocks_per_second(server):
    run = run_endurance(server, ENDURANCE_SECONDS)
    assert run.sent == ENDURANCE_SECONDS * ENDURANCE_RATE
    assert run.lost == 0
    assert run.growth is None or run.growth <= MAX_MEMORY_GROWTH


@pytest.mark.soak
def test_failed_start_of_the_benchmarked_server_raises_an_error_with_the_reason():
    with (
        pytest.raises(RuntimeError, match="did not open: kinesic: --rule rate=x"),
        open_server("--rule", "rate=x"),
    ):
        pass


@pytest.mark.soak
def test_memory_growth_of_the_server_excludes_the_initial_rise():
    memory = [(float(k), 100 if k < 5 else 200 if k < 15 else 210) for k in range(20)]
    assert _compute_memory_growth(memory, 20.0) == pytest.approx(5.0)
    assert _compute_memory_growth([], 20.0) is None
