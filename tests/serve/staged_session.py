"""A session whose loop, planner and desk are played by the tests."""

import asyncio
import re
from collections import deque
from collections.abc import Callable, Coroutine
from pathlib import Path
from types import SimpleNamespace

import pytest

from kinesic.realizer.request import Message
from kinesic.serve import session as session_module
from kinesic.serve.messages import DocumentRequest
from kinesic.serve.session import Session
from kinesic.serve.wire.quotas import Quotas

RULES = Quotas(waiting=2, planning=3.0)


class Loop:
    """A loop that does nothing."""

    def __init__(self, setup: object, sinks: object, clock: object, *, effects: object, tell: Callable, news: Callable):
        self.tell, self.news = tell, news
        self.robot, self.stops, self.late = "dummy", 0, 99
        self.alive, self.held, self.idles, self.rests, self.left, self.joined = True, False, False, True, 0, 0
        self.servos: SimpleNamespace | None = None
        self.owed = -1

    def start(self) -> None: ...

    def is_alive(self) -> bool:
        return self.alive

    def halt(self) -> None:
        self.stops += 1

    def waits(self) -> bool:
        return self.held

    def resume(self) -> None:
        self.held = False

    def settled(self) -> bool:
        return self.rests

    def owes(self, sender: int) -> bool:
        return sender == self.owed

    def leave(self) -> None:
        self.left += 1

    def join(self) -> None:
        self.joined += 1


class Planner:
    """A planner that keeps what it is sent, and is busy until it is told that it is done."""

    def __init__(self, make_setup: object, loop: Loop, *, rules: Quotas, idle: Callable, lost: Callable) -> None:
        self.idle, self.lost = idle, lost
        self.sent: deque[object] = deque()
        self.warm = self.failed = False
        self.busy, self.deaths, self.closed, self.serving = False, 0, 0, -1
        self.received: list[object] = []

    @property
    def free(self) -> bool:
        return self.warm and not self.busy

    def start(self) -> None: ...

    def send(self, request: object) -> None:
        assert self.free
        self.busy = True
        self.sent.append(request)

    def receive(self, news: object) -> None:
        self.received.append(news)

    def serves(self, sender: int) -> bool:
        return sender == self.serving

    def close(self) -> None:
        self.closed += 1

    def become_free(self) -> None:
        self.warm, self.busy = True, False
        self.idle()


class Closable:
    closed = 0

    def close(self) -> None:
        self.closed += 1


class Stage:
    """A session and all that it talks to."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.told: list[tuple[str, int]] = []
        self.time, self.slept = 1000.0, list[float]()
        self.desk, self.arming = Closable(), Closable()
        really = asyncio.sleep

        async def sleep(seconds: float) -> None:
            self.slept.append(seconds)
            self.time += seconds
            await really(0)

        def make_desk(*_: object, on_gestures_saved: Callable, folder: Path | None, writers: object) -> Closable:
            self.saved, self.folder = on_gestures_saved, folder
            return self.desk

        for name, replacement in (
            ("Loop", Loop),
            ("Planner", Planner),
            ("Desk", make_desk),
            ("Arming", lambda *_: self.arming),
            ("sleep", sleep),
            ("monotonic", lambda: self.time),
        ):
            monkeypatch.setattr(session_module, name, replacement)
        self.session = Session(lambda: None, (), RULES, lambda *told: self.told.append(told), folder=Path("kept"))
        self.loop, self.planner = self.session.loop, self.session.planner

    def document(self, name: str, sender: int = 1) -> Message:
        return Message(f'<bml id="{name}"/>', sender)

    def planned(self) -> list[str]:
        """Names of documents that are sent to the planner until nothing is left, and the names of other requests."""
        found = []
        while True:
            self.planner.become_free()
            if not self.planner.sent:
                return found
            sent = self.planner.sent.popleft()
            is_document = isinstance(sent, DocumentRequest)
            found.append(re.findall('id="(.*)"', sent.message.text)[0] if is_document else type(sent).__name__)


Act = Callable[[Stage], Coroutine]


async def settle() -> None:
    for _ in range(5):
        await asyncio.sleep(0)
