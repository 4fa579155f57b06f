"""Stubs of robot line and performer that record their calls."""

import asyncio
from collections.abc import Awaitable, Callable
from concurrent.futures import Future
from types import SimpleNamespace

import pytest

mcp = pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")

from kinesic.mcp import server as module  # noqa: E402 - needs the extra
from kinesic.mcp.robot_gate import RobotGate  # noqa: E402 - as above

Act = Callable[[object], Awaitable[None]]


class Robot:
    """Stubs of robot line, gate and performer that record their calls in order."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calls: list[object] = []
        self.fault: Exception | None = None  # error that the line and the performer raise
        self.answer: dict[str, object] = {"block": "ä"}
        self.talking = False
        documents = SimpleNamespace(
            end_talk=lambda: self.calls.append("talk ended"),
            warnings=("warned",),
            accepted_blocks=("first",),
            conversation="off",
        )
        self.documents = documents
        self._line = SimpleNamespace(
            documents=documents, stop=self._do("stop"), resume=self._do("resume"), status=self._status
        )
        setup: Future[object] = Future()
        setup.set_result("setup")
        opened: Future[object] = Future()
        opened.set_result(self._line)
        self.gate = RobotGate(opened, setup)
        monkeypatch.setattr(module, "DocumentPerformer", lambda gate: self)

    def _do(self, name: str) -> Callable[[], Awaitable[None]]:
        async def act() -> None:
            if self.fault is not None:
                raise self.fault
            self.calls.append(name)

        return act

    async def _status(self) -> str:
        if self.fault is not None:
            raise self.fault
        self.documents.accepted_blocks = ("first", "second")  # one more is accepted meanwhile
        return "status"

    def discard(self) -> None:
        self.calls.append("discard")

    async def perform(self, write: Callable[[], str]) -> dict[str, object]:
        self.calls.append(("perform", write()))
        if self.fault is not None:
            raise self.fault
        return self.answer

    async def speak(self, text: str, style: str) -> dict[str, object]:
        self.calls.append(("speak", text, style))
        return self.answer

    def run(self, act: Act, *, resumes: bool = True, categories: tuple[str, ...] = ("beat",)) -> None:
        async def whole() -> None:
            self.documents.is_talking = self.talking
            tools = module.make_server(self.gate, lambda: "lexicon", resumes=resumes, categories=categories)
            async with mcp.Client(tools) as client:
                await act(client)

        asyncio.run(whole())

    def call(self, name: str, *, resumes: bool = True, **arguments: object) -> tuple[str, bool]:
        """Return the text of a tool's answer, and whether it is an error."""
        answers: list[tuple[str, bool]] = []

        async def act(client) -> None:
            answer = await client.call_tool(name, arguments)
            answers.append(("".join(item.text for item in answer.content), answer.is_error))

        self.run(act, resumes=resumes)
        return answers[0]
