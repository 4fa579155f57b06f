"""Planner whose processes and loop are only recorded."""

from dataclasses import replace

import pytest

from kinesic.serve import forking, planner_process
from kinesic.serve.messages import PlannerReady
from kinesic.serve.planner_process import Planner
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS

from .played_children import PlayedChild, played_context

PATIENCE = 8.0  # [s] longest wait for a condition that a test expects
READY_MESSAGE = PlannerReady()
LOOP_START = "start of the loop"  # placeholder for the state of the loop from which a planner starts


class Loop:
    """Loop that only records its planners."""

    properties = "properties"

    def __init__(self) -> None:
        self.connected: list[tuple[object, object]] = []

    def snapshot(self) -> str:
        return LOOP_START

    def connect_planner(self, pipe: object, beginning: object) -> None:
        self.connected.append((pipe, beginning))


class Office:
    """Planner whose processes, loop and calls are recorded."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *, planning: float, spare_delay: float) -> None:
        self.children: list[PlayedChild] = []
        self.calls: list[object] = []
        self.loop = Loop()

        def start(*arguments: object, name: str) -> PlayedChild:
            self.children.append(PlayedChild(*arguments, name=name))
            return self.children[-1]

        monkeypatch.setattr(planner_process, "Child", start)
        monkeypatch.setattr(forking, "child_context", played_context)
        self.planner = Planner(
            make_setup,
            self.loop,
            rules=replace(DEFAULT_QUOTAS, planning=planning),
            idle=lambda: self.calls.append("idle"),
            lost=lambda request: self.calls.append(("lost", request)),
            spare_delay=spare_delay,
        )

    def of(self, name: str) -> list[PlayedChild]:
        return [child for child in self.children if child.name == name]

    def received(self, index: int = 0, *, count: int = 1) -> list[object]:
        """Return the messages to a planner process, and check their count."""
        pipe, messages = self.of("planner")[index].arguments[1], []
        for _ in range(count):
            assert pipe.poll(PATIENCE)
            messages.append(pipe.recv())
        assert not pipe.poll(0)
        return messages

    def start(self) -> Planner:
        """Start a planner process, and report that it is ready."""
        self.planner.start()
        assert self.received() == [LOOP_START]
        self.planner.receive(READY_MESSAGE)
        return self.planner


def make_setup() -> None: ...
