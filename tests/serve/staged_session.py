"""Session with stub loop, planner and desk."""

import asyncio
import re
from collections import deque
from collections.abc import Callable, Coroutine
from pathlib import Path
from types import SimpleNamespace

import pytest

from kinesic.hardware.protocol.wire import BusError
from kinesic.realizer.request import Message
from kinesic.serve import session as session_module
from kinesic.serve.feedback_queue import PendingBlock
from kinesic.serve.messages import DocumentRequest
from kinesic.serve.session import Session
from kinesic.serve.wire.quotas import Quotas
from kinesic.speech.engines.engine_voice import EngineVoice
from kinesic.speech.hibari.engine import Hibari

TEST_QUOTAS = Quotas(waiting=2, planning=3.0)


class Loop:
    """Stub loop without motion."""

    def __init__(
        self,
        setup: object,
        sinks: object,
        clock: object,
        *,
        effects: object,
        send_feedback: Callable,
        notify_server: Callable,
    ):
        self.send_feedback, self.notify_server = send_feedback, notify_server
        self.robot, self.stop_count, self.late_ticks = "dummy", 0, 99
        self.alive, self.held, self.is_idling, self.rests, self.shutdowns, self.joined = True, False, False, True, 0, 0
        self.servos: SimpleNamespace | None = None
        self.unfinished_client = -1
        self.silenced: list[str | None] = []
        self.error: BusError | None = None

    def start(self) -> None: ...

    def is_alive(self) -> bool:
        return self.alive

    def emergency_stop(self) -> None:
        self.stop_count += 1

    def change_sound(self, change: Callable) -> None:
        change(SimpleNamespace(silence=self.silenced.append))

    def needs_resume(self) -> bool:
        return self.held

    def resume(self) -> None:
        self.held = False

    def is_settled(self) -> bool:
        return self.rests

    def pending_blocks(self) -> list[PendingBlock]:
        return []

    def has_unfinished_blocks(self, client: int) -> bool:
        return client == self.unfinished_client

    def shut_down(self) -> None:
        self.shutdowns += 1

    def join(self) -> None:
        self.joined += 1


class Planner:
    """Stub planner that records requests and is busy until the test frees it."""

    def __init__(
        self,
        make_setup: object,
        loop: Loop,
        *,
        rules: Quotas,
        idle: Callable,
        lost: Callable,
        tables: tuple[str, ...],
    ) -> None:
        self.idle, self.lost, self.tables = idle, lost, tables
        self.sent: deque[object] = deque()
        self.is_warm = self.has_failed = False
        self.busy, self.deaths, self.closed, self.serving = False, 0, 0, -1
        self.received: list[object] = []

    @property
    def is_free(self) -> bool:
        return self.is_warm and not self.busy

    @property
    def is_planning(self) -> bool:
        return self.busy

    def start(self) -> None: ...

    def send(self, request: object) -> None:
        assert self.is_free
        self.busy = True
        self.sent.append(request)

    def receive(self, news: object) -> None:
        self.received.append(news)

    def serves(self, sender: int) -> bool:
        return sender == self.serving

    def close(self) -> None:
        self.closed += 1

    def become_free(self) -> None:
        self.is_warm, self.busy = True, False
        self.idle()


class Closable:
    closed = 0

    def close(self) -> None:
        self.closed += 1


class Stage:
    """Session with all its stubs."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.told: list[tuple[str, int]] = []
        self.time, self.slept = 1000.0, list[float]()
        self.desk, self.arming = Closable(), Closable()
        really = asyncio.sleep

        async def sleep(seconds: float) -> None:
            self.slept.append(seconds)
            self.time += seconds
            await really(0)

        def make_desk(
            *_: object,
            on_gestures_saved: Callable,
            folder: Path | None,
            writers: object,
            tables: tuple[str, ...],
        ) -> Closable:
            self.saved, self.folder, self.desk_tables = on_gestures_saved, folder, tables
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
        setup = SimpleNamespace(voice=EngineVoice(Hibari()))
        self.session = Session(
            lambda: setup, (), TEST_QUOTAS, lambda *told: self.told.append(told), folder=Path("kept")
        )
        self.loop, self.planner = self.session.loop, self.session.planner

    def document(self, name: str, sender: int = 1) -> Message:
        return Message(f'<bml id="{name}"/>', sender)

    def planned(self) -> list[str]:
        """Return the ids of all sent documents and the type names of other requests."""
        results = []
        while True:
            self.planner.become_free()
            if not self.planner.sent:
                return results
            sent = self.planner.sent.popleft()
            is_document = isinstance(sent, DocumentRequest)
            results.append(re.findall('id="(.*)"', sent.message.text)[0] if is_document else type(sent).__name__)


Act = Callable[[Stage], Coroutine]


async def settle() -> None:
    for _ in range(5):
        await asyncio.sleep(0)
