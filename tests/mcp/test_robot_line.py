"""The connection of the tools, before a server that answers late, of something else, or not at all."""

import json
import socket
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from threading import Event, Thread
from time import monotonic, sleep

import pytest

from kinesic.mcp import robot_line
from kinesic.mcp.robot_line import RobotError, RobotLine

WARNING = '<warningFeedback xmlns="x" id="{}" type="IMPOSSIBLE_TO_SCHEDULE">{}</warningFeedback>'
PREDICTED = '<predictionFeedback xmlns="x"><bml id="{}" globalStart="1" globalEnd="2" /></predictionFeedback>'
PROGRESS = '<blockProgress xmlns="x" id="{}:{}" globalTime="1" />'
Say = Callable[[str], None]


@contextmanager
def line(answer: Callable[[str, Say], None]) -> Iterator[RobotLine]:
    """A connection to a server that answers each message as it is told to; it ends where that raises."""
    listener = socket.create_server(("127.0.0.1", 0))

    def serve(connection: socket.socket) -> None:
        with connection:
            rest = b""
            while data := connection.recv(65_536):
                *whole, rest = (rest + data).split(b"\0")
                for message in whole:
                    if b"stop_line" in message:
                        connection.sendall(b'{"told": "stop_line"}\0')
                        continue
                    try:
                        answer(message.decode(), lambda text: connection.sendall(text.encode() + b"\0"))
                    except EOFError:
                        return

    def accept() -> None:
        for _ in range(2):
            Thread(target=serve, args=(listener.accept()[0],), daemon=True).start()

    with closing(listener):
        Thread(target=accept, daemon=True).start()
        with closing(RobotLine("127.0.0.1", listener.getsockname()[1])) as robot:
            yield robot


def test_whoever_waits_is_told_at_once_that_the_server_has_ended():
    def end(_message: str, _say: Say) -> None:
        sleep(0.1)
        raise EOFError

    with line(end) as robot:
        begun = monotonic()
        with pytest.raises(RobotError, match="is gone"):
            robot.ask("plan", bml="")
        with pytest.raises(RobotError, match="is gone"):
            robot.perform("<bml/>", "b")
        with pytest.raises(RobotError, match="is gone"):
            robot.status()
        assert monotonic() - begun < robot_line.LONGEST_WAIT / 3


def test_an_answer_that_comes_too_late_is_none_to_the_next_question(monkeypatch):
    monkeypatch.setattr(robot_line, "LONGEST_WAIT", 0.3)
    asked, late = list[int](), Event()

    def answer(message: str, say: Say) -> None:
        asked.append(json.loads(message)["id"])
        if len(asked) == 2:
            for number, state in zip(asked, ("old", "new"), strict=True):
                say(json.dumps({"told": "status", "id": number, "state": state}))
            late.set()

    with line(answer) as robot:
        with pytest.raises(RobotError, match=r"not answered in 0\.3 s"):
            robot.status()
        assert robot.status()["state"] == "new"


def test_a_block_whose_id_was_used_before_is_not_answered_by_what_is_told_of_the_old_one():
    sent = list[str]()

    def answer(document: str, say: Say) -> None:
        sent.append(document)
        if document == "first":
            say(PREDICTED.format("b"))
        elif document == "end":
            say(PROGRESS.format("b", "start"))
            say(PROGRESS.format("b", "end"))
            say(PREDICTED.format("end"))
        else:
            say(WARNING.format("b", "rule depth: too deep"))

    with line(answer) as robot:
        assert robot.perform("first", "b") == ""
        assert "not over yet" in robot.perform("second", "b")
        assert sent == ["first"]
        assert robot.perform("end", "end") == ""
        assert robot.perform("third", "b") == "rule depth: too deep"
        assert robot.perform("fourth", "b") == "rule depth: too deep"


@pytest.mark.parametrize("text", ["revoked before it began: x", "a block of this id plays already", "not performed, x"])
def test_a_block_that_never_ends_because_it_never_began_leaves_its_id_free(text):
    def answer(document: str, say: Say) -> None:
        say(PREDICTED.format(document))
        if document == "b":
            say(WARNING.format("b", text))

    with line(answer) as robot:
        assert robot.perform("b", "b") == ""
        assert robot.perform("other", "other") == ""
        assert robot.perform("b", "b") == ""


@pytest.mark.parametrize("name", ["a:b", "a:", "x &amp; y"])
def test_ids_with_colons_and_escapes_are_known_again(name):
    def answer(_document: str, say: Say) -> None:
        say(WARNING.format(f"{name}:g1", "left out: no hand"))
        say(PROGRESS.format(name, "start"))

    with line(answer) as robot:
        assert robot.perform("x", name.replace("&amp;", "&")) == ""
