"""Signals to `kinesic perform` and `kinesic serve`, as terminals and other programs send them, and the arms then."""

import json
import os
import re
import signal
import time

import pytest

from kinesic.client import Client
from kinesic.hardware.supervisor.channel import Channel

from .conftest import RAISE

pytestmark = pytest.mark.realtime

LONG = 8.0  # [s] that the hand stays raised
TOO_LONG = 1.2  # [s] out of hand, after which somebody has to consent


def test_a_performance_that_stood_still_needs_enter_and_folds_the_arms_when_its_terminal_closes(arms, perform):
    command = perform(LONG)
    command.wait(arms.raised)
    supervisor = command.supervisor()
    os.kill(supervisor, signal.SIGSTOP)
    time.sleep(TOO_LONG)
    os.kill(supervisor, signal.SIGCONT)
    command.wait(lambda: "the servos hold: Enter goes on" in command.said)
    assert arms.still(0.5)
    assert arms.record().torque[-1].all()
    command.press(b"\n")
    journal = command.folder / "out" / "events.jsonl"
    command.wait(lambda: "-> active" in journal.read_text().split("paused")[-1])
    end(command, "closed")
    assert command.end() == 1, command.said
    assert arms.home
    assert command.leaves_nothing()
    assert "Traceback" not in command.said
    assert json.loads((command.folder / "out" / "report.json").read_text())["servos"]["ending"] == "ended"
    assert sorted(path.name for path in command.folder.iterdir()) == ["out", "raise.bml"]


@pytest.mark.soak
@pytest.mark.parametrize("way", ["Ctrl-C", "SIGTERM", "SIGTERM to it alone", "SIGKILL"])
def test_a_performance_that_is_ended_folds_the_arms(arms, perform, way: str):
    command = perform(LONG)
    command.wait(arms.raised)
    end(command, way)
    assert command.end() == (-signal.SIGKILL if way == "SIGKILL" else 1), command.said
    clean = command.leaves_nothing()
    assert clean or way == "SIGKILL"
    assert arms.home
    assert "Traceback" not in command.said


@pytest.mark.soak
@pytest.mark.parametrize("way", ["Ctrl-C", "SIGTERM", "SIGTERM to it alone", "SIGKILL"])
def test_a_server_that_is_ended_folds_the_arms_first(arms, run, way: str):
    command, client = serve(arms, run)
    with client:
        client.send(RAISE.format(LONG, LONG + 1.0))
        command.wait(arms.raised)
        end(command, way)
        assert command.end() == (-signal.SIGKILL if way == "SIGKILL" else 0), command.said
    clean = command.leaves_nothing()
    assert clean or way == "SIGKILL"
    assert arms.home
    assert "Traceback" not in command.said


def test_a_server_that_stood_still_needs_consent_and_one_whose_terminal_closes_folds_the_arms(arms, run):
    command, client = serve(arms, run, "--learn", "none")
    with client:
        client.send(RAISE.format(LONG, LONG + 1.0))
        command.wait(arms.raised)
        supervisor = arms.supervisor()
        command.process.send_signal(signal.SIGSTOP)
        command.wait(lambda: stood(supervisor, TOO_LONG))  # when it has performed what had been handed over
        command.process.send_signal(signal.SIGCONT)
        command.wait(lambda: state(client) == "stopped")
        assert arms.still(0.5)
        assert arms.record().torque[-1].all()
        client.do("resume")
        command.wait(lambda: state(client) == "playing")
        end(command, "closed")
        assert command.end() == 0, command.said
    assert arms.home
    assert command.leaves_nothing()
    assert "Traceback" not in command.said


def end(command, way: str) -> None:
    if way == "Ctrl-C":
        command.press(b"\x03")
    elif way == "closed":
        command.close_terminal()
    elif way == "SIGTERM":
        command.signal_all(signal.SIGTERM)
    elif way == "SIGTERM to it alone":
        command.process.send_signal(signal.SIGTERM)
    else:
        command.process.kill()


def stood(supervisor: Channel, seconds: float) -> bool:
    """Whether the performance stands still for a while."""
    before = supervisor.status().time
    time.sleep(seconds)
    return supervisor.status().time == before


def serve(arms, run, *more: str):
    """A server in a terminal, and a client of it."""
    options = ("--on", "servos", "--port", f"body={arms.port}", "--voice", "durations", "--no-sound")
    command = run("serve", *options, *more, "--listen", "127.0.0.1:0")
    command.wait(lambda: "listening at" in command.said)
    return command, Client(port=int(re.search(r"listening at 127.0.0.1:(\d+)", command.said)[1]))


def state(client) -> str:
    client.do("status")
    while True:
        message = client.receive(20)
        if message.startswith("{"):
            return json.loads(message).get("state", "")
