"""Live server under load for minutes, and with mutated documents."""

import json
import os
import random
import re
import signal
import subprocess
import sys

import pytest

from kinesic.bench.blocks import find_corpus
from kinesic.bench.bml.emergency_stop import NO_FLOOD, measure_stops, stop_metrics, watched_server
from kinesic.bench.bml.flood import FLOOD_FUNCTIONS
from kinesic.bench.bml.server import MAX_MEMORY_GROWTH, open_server, run_endurance
from kinesic.body.config import CONFIGS
from kinesic.client import Client
from kinesic.report.batch import documents
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS

from ..serve.mutations import mutate
from .crowd import crowd
from .memory_log import WARM_UP_TIME, growth

DOCUMENT_COUNT = 10_000
LOAD_MINUTES = 10
CROWD_MINUTES = 20  # duration of the test with six clients and floods, unless KINESIC_SOAK_MINUTES is set
MAX_GROWTH = 2.0  # [%] largest growth of the memory of all processes after the first five minutes
STOP_COUNT = 200  # number of emergency stops per kind of flood
MAX_LOAD = 4.0  # load average above which latencies are not guaranteed

pytestmark = pytest.mark.soak


def test_server_loses_no_block_at_ten_per_second_with_bounded_memory_growth():
    with open_server() as server:
        lasting = run_endurance(server, 60.0 * LOAD_MINUTES)
    assert lasting.lost == 0, lasting
    assert lasting.growth is None or lasting.growth <= MAX_MEMORY_GROWTH, lasting


def test_six_clients_get_all_feedback_once_in_order_with_bounded_memory_growth():
    duration = 60.0 * float(os.environ.get("KINESIC_SOAK_MINUTES", CROWD_MINUTES))
    with open_server() as server:
        report = crowd(server, duration)
    assert not report.faults, report.faults
    window = min(WARM_UP_TIME, duration / 4), duration
    total = report.memory.total(*window)
    assert growth(total) <= MAX_GROWTH, "\n".join(report.memory.lines(*window))
    for role in report.memory.roles:
        before, after = report.memory.private(*window, role)
        assert after - before <= MAX_GROWTH / 100.0 * total[0], "\n".join(report.memory.lines(*window))


@pytest.mark.parametrize("name", [NO_FLOOD, *FLOOD_FUNCTIONS])
def test_emergency_stops_meet_their_latency_limits_under_each_network_flood(name):
    if (load := os.getloadavg()[0]) > MAX_LOAD:
        pytest.skip(f"the load is {load:.1f}, stops are promised up to {MAX_LOAD:g}")
    with watched_server() as server:
        acknowledged, still = stop_metrics(name, measure_stops(server, name, STOP_COUNT))
    assert acknowledged.ok, acknowledged
    assert still.ok, still


def test_mutated_documents_neither_crash_nor_stall_the_server():
    where = find_corpus()
    files = sorted((CONFIGS / "bml").glob("*.bml")) if where is None else documents((where,))
    chance = random.Random(7)
    texts = [file.read_bytes()[:6000] for file in files]
    patient = ("--rule", "planning=120", "--rule", "rate=1000", "--rule", "burst=1000")
    with open_server(*patient) as server, Client(port=server.port) as client:
        for seed in range(DOCUMENT_COUNT):
            text = mutate(chance.choice(texts), seed).replace(b"\0", b" ")
            if len(text) > DEFAULT_QUOTAS.message:
                _sent_home(server.port, text)
            else:
                client.send_bytes(text)
            status = _status(client)
            while status["waiting"]:
                client.receive(0.01)
                status = _status(client)
            if seed % 50 == 49:
                client.do("interrupt")
        assert status["deaths"] == 0
        client.do("interrupt")
        messages = list(client.perform('<bml id="sane"><head id="h" lexeme="NOD" start="0"/></bml>'))
    assert re.search(r'id="sane:end"', messages[-1])


def test_server_on_simulated_servos_performs_and_folds_the_arms_on_ctrl_c(tmp_path):
    simulate = [sys.executable, "-m", "kinesic", "servos", "simulate", "--folder", str(tmp_path)]
    with subprocess.Popen(simulate, stdout=subprocess.PIPE, text=True) as servos:
        try:
            assert "body" in servos.stdout.readline()
            with open_server("--on", "servos", "--port", str(tmp_path / "body"), cwd=tmp_path) as server:
                _performed(server.port)
                server.process.send_signal(signal.SIGINT)
                assert server.process.wait(60.0) == 0
        finally:
            servos.kill()
    events = [json.loads(line) for line in (tmp_path / "events.jsonl").read_text().splitlines()]
    assert events[-1]["text"] == "release -> closed (done)"


def _performed(port: int) -> None:
    beat = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" start="0.3" stroke="1"/>'
    with Client(port=port) as client:
        messages = list(client.perform(f'<bml id="one">{beat}</bml>'))
        late = [float(lag) for message in messages for lag in re.findall(r'lag="([^"]*)"', message)]
        assert late
        assert all(abs(lag) < 0.3 for lag in late)
        client.send(f'<bml id="two">{beat}</bml>')
        while 'id="two:start"' not in client.receive(60.0):
            pass
        client.stop()
        assert _status(client)["state"] == "stopped"
        client.do("resume")
        messages = list(client.perform(f'<bml id="three">{beat}</bml>'))
    assert 'id="three:end"' in messages[-1]


def _sent_home(port: int, oversized: bytes) -> None:
    """Send a message that is too long, and check that the connection is closed."""
    with Client(port=port) as client:
        client.send_bytes(oversized)
        heard = client.receive(60.0)
        assert heard is not None
        assert "rule message" in heard


def _status(client: Client) -> dict[str, object]:
    client.do("status")
    while True:
        message = client.receive(60.0)
        assert message is not None, "it has stalled"
        if message.startswith("{") and (data := json.loads(message))["told"] == "status":
            return data
