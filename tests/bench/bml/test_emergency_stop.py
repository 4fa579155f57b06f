"""The bench of the emergency stop: that it sees stops, and that its floods are floods."""

import ast
import json
import socket
import sys
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from kinesic.bench.bml import emergency_stop, flood
from kinesic.bench.bml.emergency_stop import IDLE, Stopping, flooding, measure_stops, stop_figures, watched_server
from kinesic.bench.bml.witnessed_server import GoalRecorder, read_goals
from kinesic.body.command import Command
from kinesic.client import Client

pytestmark = pytest.mark.realtime

STOPS = 4  # each way once


@pytest.fixture(scope="module")
def server():
    with watched_server() as found:
        yield found


@pytest.fixture
def at_once(monkeypatch):
    """For tests that see themselves when a flood has come."""
    monkeypatch.setattr(emergency_stop, "RISING", 0.0)


@pytest.mark.parametrize("name", [IDLE, "fragments"])
def test_every_stop_is_acknowledged_and_goals_come_to_rest(server, name):
    found = measure_stops(server, name, STOPS)
    assert len(found) == STOPS
    assert all(each.acknowledged > 0.0 for each in found)
    assert any(each.still is not None and each.still > 0.0 for each in found), "the robot was to move"


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
@pytest.mark.usefixtures("at_once")
def test_floods_say_what_they_are_to_say(name, first):
    with socket.create_server(("127.0.0.1", 0)) as listener, flooding(name, listener.getsockname()[1]):
        connection, _ = listener.accept()
        with connection:
            assert connection.recv(len(first), socket.MSG_WAITALL) == first


def test_a_flood_of_questions_asks_what_is_answered(server):
    with Client(port=server.port) as client:
        answers = {"plan", "gesture", "reach", "saved", "document", "documents"}
        for number, question in enumerate(flood._questions(1)):
            if b"reach" not in question or number % 10 == 0:
                client.send_bytes(question.rstrip(b"\0"))
        end = monotonic() + 30.0
        while answers and monotonic() < end:
            told = json.loads(client.receive(30.0) or "{}")
            assert told["told"] not in ("refused", "failed"), told
            answers.discard(told["told"])
        assert not answers


@pytest.mark.usefixtures("at_once")
def test_a_crowd_connects_and_comes_again():
    with (
        socket.create_server(("127.0.0.1", 0), backlog=16) as listener,
        flooding("connections", listener.getsockname()[1]),
    ):
        for _ in range(flood.CROWD + 10):
            listener.accept()[0].close()


def test_floods_share_no_code_with_the_server():
    tree = ast.parse(Path(flood.__file__).read_text(encoding="utf-8"))
    imported = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    imported += [str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert {name.split(".")[0] for name in imported} <= sys.stdlib_module_names


def test_goals_are_read_back(tmp_path):
    recorder = GoalRecorder(tmp_path / "goals")
    nothing = np.zeros(3)
    for k in range(5):
        recorder.write(Command(k / 100, nothing, nothing, nothing, goals=np.full(3, float(k))))
    found = read_goals(tmp_path / "goals", 3, 2)
    recorder.close()
    assert found[:, 1:].tolist() == [[3.0] * 3, [4.0] * 3]
    assert (np.diff(found[:, 0]) >= 0.0).all()


def test_figures_are_the_worst_hundredth_and_say_when_nothing_moved():
    stops = [Stopping(float(k), None) for k in range(101)]
    acknowledged, still = stop_figures(IDLE, stops)
    assert acknowledged.name == "bml.stop.acknowledged_p99.idle"
    assert acknowledged.value == pytest.approx(99.0)
    assert acknowledged.ok is False
    assert (still.value, still.why) == (None, "nothing moved")
