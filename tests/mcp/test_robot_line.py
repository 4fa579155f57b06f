"""Tool connections to a server with late, wrong or missing answers."""

import asyncio
import json
import socket
from collections.abc import Awaitable, Callable
from threading import Event
from time import monotonic, sleep

import pytest

from kinesic.mcp import document_line, robot_line
from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.robot_line import RobotLine

from .fake_server import PINGED, PREDICTION, PROGRESS, WARNING, Say, line


def run(act: Callable[[], Awaitable[None]]) -> None:
    asyncio.run(asyncio.wait_for(act(), 30))


def ignore(_message: str, _say: Say) -> None:
    """Answer nothing."""


def test_opened_robot_connections_send_three_pings_and_one_stop_line_registration():
    with line(ignore) as (_, server):
        assert sorted(server.received) == [*['{"do": "ping"}'] * 3, '{"do": "stop_line"}']


def test_callers_that_wait_for_the_robot_server_fail_immediately_when_the_server_ends():
    def end(_message: str, _say: Say) -> None:
        sleep(0.1)
        raise EOFError

    with line(end) as (robot, _):

        async def act() -> None:
            begun = monotonic()
            with pytest.raises(RobotError, match=r"is gone.*start it again"):
                await robot.documents.ask("plan", bml="")
            with pytest.raises(RobotError, match="is gone"):
                await robot.documents.perform("<bml/>", "b")
            with pytest.raises(RobotError, match="is gone"):
                await robot.resume()
            assert monotonic() - begun < document_line.MAX_WAIT / 3

        run(act)


def test_late_planning_answer_is_not_assigned_to_the_next_planning_request(monkeypatch):
    monkeypatch.setattr(document_line, "MAX_WAIT", 0.3)
    asked = list[int]()

    def answer(message: str, say: Say) -> None:
        if message == "<bml/>":
            return
        asked.append(json.loads(message)["id"])
        if len(asked) == 2:
            for number, block in zip(asked, ("old", "new"), strict=True):
                say(json.dumps({"told": "plan", "id": number, "block": block}))

    with line(answer) as (robot, _):

        async def act() -> None:
            with pytest.raises(RobotError, match=r"not answered in 0\.3 s; ask for status"):
                await robot.documents.ask("plan", bml="")
            assert (await robot.documents.ask("plan", bml=""))["block"] == "new"
            assert robot.documents._answers == {}
            with pytest.raises(RobotError, match="not answered"):
                await robot.documents.perform("<bml/>", "b")

        run(act)


def test_block_id_is_refused_until_its_block_has_ended_and_can_then_be_reused():
    sent = list[str]()

    def answer(document: str, say: Say) -> None:
        sent.append(document)
        if document == "first":
            say(PREDICTION.format("b"))
        elif document == "end":
            say(PROGRESS.format("b", "start"))
            say(PROGRESS.format("b", "end"))
            say(PREDICTION.format("end"))
        else:
            say(WARNING.format("b", "rule depth: too deep"))

    with line(answer) as (robot, _):

        async def act() -> None:
            perform = robot.documents.perform
            assert await perform("first", "b") == ""
            assert "not ended yet" in await perform("second", "b")
            assert sent == ["first"]
            assert await perform("end", "end") == ""
            assert await perform("third", "b") == "rule depth: too deep"
            assert await perform("fourth", "b") == "rule depth: too deep"
            assert robot.documents.outcome("b") == "not performed: rule depth: too deep"
            assert robot.documents.outcome("end") == ""
            assert robot.documents.outcome("other") is None
            assert robot.documents.warnings == ["b: rule depth: too deep"] * 2

        run(act)


@pytest.mark.parametrize("text", ["revoked before it began: x", "a block of this id plays already", "not performed, x"])
def test_id_of_a_block_that_never_began_can_be_reused(text: str):
    def answer(document: str, say: Say) -> None:
        say(PREDICTION.format(document))
        if document == "b":
            say(WARNING.format("b", text))

    with line(answer) as (robot, _):

        async def act() -> None:
            assert await robot.documents.perform("b", "b") == ""
            assert await robot.documents.perform("other", "other") == ""
            assert await robot.documents.perform("b", "b") == ""

        run(act)


@pytest.mark.parametrize("name", ["a:b", "a:", "x &amp; y"])
def test_block_ids_with_colons_and_escapes_are_matched(name: str):
    def answer(_document: str, say: Say) -> None:
        say(WARNING.format(f"{name}:g1", "left out: no hand"))
        say(PROGRESS.format(name, "start"))

    with line(answer) as (robot, _):

        async def act() -> None:
            assert await robot.documents.perform("x", name.replace("&amp;", "&")) == ""

        run(act)


@pytest.mark.parametrize("name", ["b", "message", "commented"])
def test_refusal_is_matched_by_the_planned_or_the_written_block_id_or_the_general_id_message(name: str):
    def answer(_document: str, say: Say) -> None:
        say(WARNING.format("other", "rule depth: another block"))
        say("no XML")
        say(WARNING.format(name, "rule stopped: resume first"))

    with line(answer) as (robot, _):

        async def act() -> None:
            assert await robot.documents.perform("x", "b", "commented") == "rule stopped: resume first"

        run(act)


def test_refusal_without_reason_is_still_a_refusal():
    def answer(_document: str, say: Say) -> None:
        say('<warningFeedback xmlns="x" id="b" type="PARSING_FAILURE"/>')

    with line(answer) as (robot, _):

        async def act() -> None:
            assert "without a reason" in await robot.documents.perform("x", "b")

        run(act)


def test_planning_request_refused_by_the_server_fails_immediately():
    def answer(_question: str, say: Say) -> None:
        say(WARNING.format("b", "rule depth: another message"))
        say(WARNING.format("message", "rule rate: at most 50 messages a second"))

    with line(answer) as (robot, _):

        async def act() -> None:
            begun = monotonic()
            with pytest.raises(RobotError, match="rule rate"):
                await robot.documents.ask("plan", bml="x")
            assert monotonic() - begun < document_line.MAX_WAIT / 3

        run(act)


def test_message_above_the_maximum_length_is_not_sent_to_the_server():
    with line(ignore) as (robot, server):

        async def act() -> None:
            with pytest.raises(
                RefusedError, match=r"has 10000\d\d bytes, at most 1000000 are accepted: send it in parts"
            ):
                await robot.documents.ask("plan", bml="ü" * 500_000)
            with pytest.raises(RefusedError, match="1000002 bytes"):
                await robot.documents.perform("ü" * 500_001, "b")

        run(act)
        assert not [message for message in server.received if "ü" in message]


def test_message_of_the_maximum_length_is_sent_to_the_server():
    def answer(document: str, say: Say) -> None:
        say(WARNING.format("b", f"rule length: {len(document.encode())}"))

    with line(answer) as (robot, _):

        async def act() -> None:
            assert await robot.documents.perform("ü" * 500_000, "b") == "rule length: 1000000"

        run(act)


def test_status_and_stop_are_answered_while_a_document_is_pending():
    waiting = Event()

    def answer(_document: str, _say: Say) -> None:
        waiting.set()

    with line(answer) as (robot, server):

        async def act() -> None:
            document = asyncio.create_task(robot.documents.perform("x", "b"))
            while not waiting.is_set():
                await asyncio.sleep(0.01)
            assert await robot.status() == {"told": "status", "state": "resting", "stops": 3}
            await robot.stop()
            assert not document.done()
            document.cancel()
            assert server.stops == 1

        run(act)


def test_document_of_a_cancelled_caller_is_not_sent():
    def answer(_document: str, say: Say) -> None:
        sleep(0.2)
        say(PREDICTION.format("b"))

    with line(answer) as (robot, server):

        async def act() -> None:
            busy = asyncio.create_task(robot.documents.send(lambda: sleep(0.2) or "slow"))
            await asyncio.sleep(0.05)
            document = asyncio.create_task(robot.documents.perform("late", "late"))
            await asyncio.sleep(0.05)
            document.cancel()
            await robot.resume()
            await busy
            while '{"do": "resume"}' not in server.received:
                await asyncio.sleep(0.01)

        run(act)
        assert [item for item in server.received if "ping" not in item and "line" not in item] == [
            "slow",
            '{"do": "resume"}',
        ]


def test_closed_emergency_stop_connection_is_reopened():
    with line(ignore, silent_stops=1) as (robot, server):
        run(robot.stop)
        assert server.stops == 2
        assert server.received.count('{"do": "stop_line"}') == 2


def test_unconfirmed_stop_error_mentions_the_power_switch():
    with line(ignore, silent_stops=2) as (robot, _):

        async def act() -> None:
            with pytest.raises(RobotError, match="use the switch that cuts the power"):
                await robot.stop()
            await robot.stop()

        run(act)


@pytest.mark.parametrize("answer", ['<warningFeedback id="message">rule rate</warningFeedback>', ""])
def test_missing_answer_to_a_robot_status_request_is_reported(monkeypatch, answer: str):
    monkeypatch.setattr(robot_line, "STATUS_TIMEOUT", 0.1)
    with line(ignore) as (robot, server):
        monkeypatch.setattr(
            server, "_take", lambda message, say: say(answer or PINGED) if "ping" in message or answer else None
        )

        async def act() -> None:
            with pytest.raises(RobotError, match="the server is gone"):
                await robot.status()

        run(act)


def test_connecting_to_a_missing_server_raises_an_os_error():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    with pytest.raises(OSError, match="refused"):
        RobotLine("127.0.0.1", port)
