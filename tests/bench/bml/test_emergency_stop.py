"""Benchmark of the emergency stop: recorded stops and kinds of floods."""

import ast
import json
import socket
import sys
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from kinesic.bench.bml import emergency_stop, flood
from kinesic.bench.bml.emergency_stop import NO_FLOOD, StopDelay, flooding, measure_stops, stop_metrics, watched_server
from kinesic.bench.bml.witnessed_server import GoalRecorder, read_goals
from kinesic.body.command import Command
from kinesic.client import Client

pytestmark = pytest.mark.realtime

STOP_COUNT = 4  # every channel once


@pytest.fixture(scope="module")
def server():
    with watched_server() as running:
        yield running


@pytest.fixture
def no_start_time(monkeypatch):
    """Remove the wait after the start of a flood."""
    monkeypatch.setattr(emergency_stop, "FLOOD_START_TIME", 0.0)


@pytest.mark.parametrize("name", [NO_FLOOD, "fragments"])
def test_emergency_stops_are_acknowledged_and_servo_goals_become_constant(server, name):
    delays = measure_stops(server, name, STOP_COUNT)
    assert len(delays) == STOP_COUNT
    assert all(stop.acknowledged > 0.0 for stop in delays)
    assert any(stop.still is not None and stop.still > 0.0 for stop in delays), "the robot did not move"


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("fragments", b"GET / HTTP/1.1"),
        ("drips", b"<"),
        ("blocks", b'<bml id="flood1">'),
        ("documents", b"<bml id="),
        ("questions", b'{"do": "watch", "rate": 50}\0{"do": "plan", '),
    ],
)
@pytest.mark.usefixtures("no_start_time")
def test_flood_client_first_sends_the_bytes_of_its_kind_of_flood(name, first):
    with socket.create_server(("127.0.0.1", 0)) as listener, flooding(name, listener.getsockname()[1]):
        connection, _ = listener.accept()
        with connection:
            assert connection.recv(len(first), socket.MSG_WAITALL) == first


def test_flooding_client_requests_are_valid_and_answered(server):
    with Client(port=server.port) as client:
        answers = {"plan", "gesture", "reach", "saved", "document", "documents"}
        for number, question in enumerate(flood._list_requests(1)):
            if b"reach" not in question or number % 10 == 0:
                client.send_bytes(question.rstrip(b"\0"))
        end = monotonic() + 30.0
        while answers and monotonic() < end:
            reply = json.loads(client.receive(30.0) or "{}")
            assert reply["told"] not in ("refused", "failed"), reply
            answers.discard(reply["told"])
        assert not answers


@pytest.mark.usefixtures("no_start_time")
def test_flood_client_reopens_closed_idle_connections():
    with (
        socket.create_server(("127.0.0.1", 0), backlog=16) as listener,
        flooding("connections", listener.getsockname()[1]),
    ):
        listener.settimeout(30.0)
        ports = set()
        for _ in range(flood.IDLE_CONNECTIONS + 10):
            connection, (_, port) = listener.accept()
            connection.close()
            ports.add(port)
    assert len(ports) > flood.IDLE_CONNECTIONS / 2


def test_flood_client_imports_only_the_standard_library():
    tree = ast.parse(Path(flood.__file__).read_text(encoding="utf-8"))
    imported = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    imported += [str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert {name.split(".")[0] for name in imported} <= sys.stdlib_module_names


def test_last_recorded_servo_goals_are_read_back_from_the_file(tmp_path):
    recorder = GoalRecorder(tmp_path / "goals")
    zeros = np.zeros(3)
    for k in range(5):
        recorder.write(Command(k / 100, zeros, zeros, zeros, setpoints=np.full(3, float(k))))
    commands = read_goals(tmp_path / "goals", 3, 2)
    recorder.close()
    assert commands[:, 1:].tolist() == [[3.0] * 3, [4.0] * 3]
    assert (np.diff(commands[:, 0]) >= 0.0).all()


@pytest.mark.soak
def test_stop_delay_metric_is_the_99th_percentile_or_null_if_no_servo_moved():
    stops = [StopDelay(float(k), None) for k in range(101)]
    acknowledged, still = stop_metrics(NO_FLOOD, stops)
    assert acknowledged.name == "bml.stop.acknowledged_p99.idle"
    assert acknowledged.value == pytest.approx(99.0)
    assert acknowledged.ok is False
    assert (still.value, still.why) == (None, "nothing moved")
