"""Reaction of `kinesic perform` and `kinesic serve` to signals and closed terminals."""

import json
import os
import re
import signal
import time

import pytest

from kinesic.body.robot import Robot
from kinesic.client import Client
from kinesic.hardware.supervisor.channel import Channel

from ....reduced_robots import write_robot
from .conftest import RAISE_BML

pytestmark = pytest.mark.realtime

RAISED_DURATION = 8.0  # [s] duration for which the hand is raised
LONG_INTERRUPTION = 1.2  # [s] suspension after which a person must confirm


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    """Robot with arms only, so that the tests take less time."""
    return Robot.load(write_robot(tmp_path_factory.mktemp("robot"), "neck", "torso", "clavicles"))


def test_suspended_performance_resumes_on_enter_and_folds_arms_on_hangup(arms, perform):
    command = perform(RAISED_DURATION)
    command.wait(arms.is_raised)
    supervisor = command.supervisor()
    os.kill(supervisor, signal.SIGSTOP)
    time.sleep(LONG_INTERRUPTION)
    os.kill(supervisor, signal.SIGCONT)
    command.wait(lambda: "the servos hold: Enter resumes" in command.output)
    assert arms.is_still(0.5)
    assert arms.record().torque[-1].all()
    command.press(b"\n")
    journal = command.folder / "out" / "events.jsonl"
    command.wait(lambda: "-> active" in journal.read_text().split("paused")[-1])
    end(command, "closed")
    assert command.end() == 1, command.output
    assert arms.is_home
    assert command.has_cleaned_up()
    assert "Traceback" not in command.output
    assert json.loads((command.folder / "out" / "report.json").read_text())["servos"]["ending"] == "ended"
    assert sorted(path.name for path in command.folder.iterdir()) == ["out", "raise.bml"]


@pytest.mark.soak
@pytest.mark.parametrize("ending", ["Ctrl-C", "SIGTERM", "SIGTERM to the process alone", "SIGKILL"])
def test_terminated_performance_folds_the_arms(arms, perform, ending: str):
    command = perform(RAISED_DURATION)
    command.wait(arms.is_raised)
    end(command, ending)
    assert command.end() == (-signal.SIGKILL if ending == "SIGKILL" else 1), command.output
    clean = command.has_cleaned_up()
    assert clean or ending == "SIGKILL"
    assert arms.is_home
    assert "Traceback" not in command.output


@pytest.mark.soak
@pytest.mark.parametrize("ending", ["Ctrl-C", "SIGTERM", "SIGTERM to the process alone", "SIGKILL"])
def test_terminated_server_folds_the_arms_before_it_exits(robot, arms, run, ending: str):
    command, client = serve(robot, arms, run)
    with client:
        client.send(RAISE_BML.format(RAISED_DURATION, RAISED_DURATION + 1.0))
        command.wait(arms.is_raised)
        end(command, ending)
        assert command.end() == (-signal.SIGKILL if ending == "SIGKILL" else 0), command.output
    clean = command.has_cleaned_up()
    assert clean or ending == "SIGKILL"
    assert arms.is_home
    assert "Traceback" not in command.output


@pytest.mark.soak
def test_suspended_server_resumes_on_request_and_folds_arms_when_the_terminal_closes(robot, arms, run):
    command, client = serve(robot, arms, run, "--learn", "none")
    with client:
        client.send(RAISE_BML.format(RAISED_DURATION, RAISED_DURATION + 1.0))
        command.wait(arms.is_raised)
        supervisor = arms.supervisor()
        command.process.send_signal(signal.SIGSTOP)
        command.wait(
            lambda: has_stood_still(supervisor, LONG_INTERRUPTION)
        )  # until the buffered setpoints are performed
        command.process.send_signal(signal.SIGCONT)
        command.wait(lambda: state(client) == "stopped")
        assert arms.is_still(0.5)
        assert arms.record().torque[-1].all()
        client.do("resume")
        command.wait(lambda: state(client) == "playing")
        end(command, "closed")
        assert command.end() == 0, command.output
    assert arms.is_home
    assert command.has_cleaned_up()
    assert "Traceback" not in command.output


def end(command, ending: str) -> None:
    if ending == "Ctrl-C":
        command.press(b"\x03")
    elif ending == "closed":
        command.close_terminal()
    elif ending == "SIGTERM":
        command.signal_all(signal.SIGTERM)
    elif ending == "SIGTERM to the process alone":
        command.process.send_signal(signal.SIGTERM)
    else:
        command.process.kill()


def has_stood_still(supervisor: Channel, seconds: float) -> bool:
    """Return whether the performance time stands still for a duration [s]."""
    before = supervisor.status().time
    time.sleep(seconds)
    return supervisor.status().time == before


def serve(robot, arms, run, *options_of_test: str):
    """Start a server in a terminal, and return it with a connected client."""
    options = (
        "--robot",
        robot.path,
        "--on",
        "servos",
        "--port",
        f"body={arms.port}",
        "--voice",
        "durations",
        "--no-sound",
    )
    command = run("serve", *options, *options_of_test, "--listen", "127.0.0.1:0")
    command.wait(lambda: "listening at" in command.output)
    return command, Client(port=int(re.search(r"listening at 127.0.0.1:(\d+)", command.output)[1]))


def state(client) -> str:
    client.do("status")
    while True:
        message = client.receive(20)
        if message.startswith("{"):
            return json.loads(message).get("state", "")
