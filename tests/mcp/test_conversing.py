"""Tools that begin, end and direct a conversation, with a scripted server."""

import asyncio
import json
from concurrent.futures import Future

import pytest

mcp = pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")

from kinesic.mcp.conversing import BEGIN_FIRST, add_conversation_tools  # noqa: E402 - needs the extra
from kinesic.mcp.robot_gate import RobotGate  # noqa: E402 - as above
from kinesic.mcp.tool_server import ToolServer  # noqa: E402 - as above

from .fake_server import Say, line  # noqa: E402 - as above


class ConversingServer:
    """Scripted server that refuses to converse while it is stopped."""

    def __init__(self) -> None:
        self.requests: list[dict[str, object]] = []  # messages about the conversation
        self.obstacle = ""
        self.reports: list[str] = []  # states reported before the answer to the next request

    def answer(self, message: str, say: Say) -> None:
        request = json.loads(message)
        if request["do"] == "status":
            for state in self.reports:
                say(json.dumps({"told": "conversing", "state": state}))
            say(json.dumps({"told": "status", "id": request["id"]}))
            return
        self.requests.append(request)
        if self.obstacle:
            say(json.dumps({"told": "refused", "do": "converse", "why": self.obstacle}))


def call(server: ConversingServer, *calls: tuple[str, dict[str, object]]) -> list[object]:
    """Return the decoded answers of tool calls.

    A failed call gives the text of its error.
    """

    async def run() -> list[object]:
        with line(server.answer) as (robot, _):
            opened: Future = Future()
            opened.set_result(robot)
            tools = ToolServer("test")
            add_conversation_tools(tools, RobotGate(opened, Future()))
            async with mcp.Client(tools) as client:
                answers = [await client.call_tool(name, arguments) for name, arguments in calls]
        texts = ["".join(item.text for item in answer.content) for answer in answers]
        return [text if answer.is_error else json.loads(text) for text, answer in zip(texts, answers, strict=True)]

    return asyncio.run(asyncio.wait_for(run(), 30))


def test_converse_tool_sends_its_options_and_returns_the_state():
    server = ConversingServer()
    options = {"on": True, "amount": 0.5, "fillers": True}
    assert call(server, ("converse", options), ("converse", {"on": False})) == [{"state": "idle"}, {"state": "off"}]
    ends = {"do": "converse", "on": False, "amount": 1.0, "fillers": False}
    assert server.requests == [{"do": "converse", **options}, ends]


def test_converse_tool_returns_the_state_that_the_server_reports():
    server = ConversingServer()
    server.reports = ["attending", "listening"]
    assert call(server, ("converse", {"on": True})) == [{"state": "listening"}]


def test_converse_tool_passes_on_the_refusal_of_the_server():
    server = ConversingServer()
    server.obstacle = "an emergency stop holds; resume first"
    assert call(server, ("converse", {"on": True}), ("think", {"on": True})) == [server.obstacle, BEGIN_FIRST]


def test_think_tool_without_a_conversation_reports_an_error():
    server = ConversingServer()
    calls = (("think", {"on": True}), ("converse", {"on": True}), ("think", {"on": True}), ("think", {"on": False}))
    assert call(server, *calls) == [BEGIN_FIRST, {"state": "idle"}, {"thinking": True}, {"thinking": False}]
    assert server.requests[1:] == [{"do": "think", "on": True}, {"do": "think", "on": False}]


def test_tool_connection_records_that_the_server_ended_a_conversation():
    server = ConversingServer()

    async def run() -> list[str]:
        with line(server.answer) as (robot, _):
            states = [await robot.documents.converse(on=True, amount=1.0, fillers=False)]
            server.reports = ["attending", "off"]
            await robot.documents.ask("status")
            return [*states, robot.documents.conversation]

    assert asyncio.run(asyncio.wait_for(run(), 30)) == ["idle", "off"]
