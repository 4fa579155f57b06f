"""Planner state with stubbed scene, texts and idle motion."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

from kinesic.motion.trajectory import stay
from kinesic.realizer.realizer import Scene
from kinesic.serve import planner as module
from kinesic.serve.messages import (
    LoopProperties,
    LoopStart,
)
from kinesic.serve.planner import PlannerState
from kinesic.serve.shared_scene import Verdict
from kinesic.serve.tracks import NO_ACCOMPANIMENT
from kinesic.serve.wire.quotas import Quotas

NOW = 7.0  # [s] time of the clock


class PlayedScene:
    """Shared scene that accepts or rejects all changes."""

    def __init__(self, setup, loop, properties, *, beginning, other_clients, on_halt) -> None:
        self.scene, self.stops = Scene.of(setup), beginning.stops
        self.other_clients, self.on_halt = other_clients, on_halt
        self.verdict = Verdict.ACCEPTED
        self.proposals, self.told, self.waited, self.halts, self.renewed = [], [], [], [], []
        self.replans = []

    def propose(self, change):
        self.proposals.append(change)
        after = change(self.scene, NOW)
        if self.verdict is Verdict.ACCEPTED:
            self.scene = after
        return self.verdict

    def tell(self, message, sender) -> None:
        self.told.append((message, sender))

    def wait_for_stops(self, stops) -> None:
        self.waited.append(stops)

    def handle_stop(self, halted) -> None:
        self.halts.append(halted)

    def renew(self, setup) -> None:
        self.renewed.append(setup)

    def pop_replan(self):
        return self.replans.pop(0) if self.replans else None


class PlayedTalks:
    """Streamed texts with prepared phrases."""

    def __init__(self, character) -> None:
        self.character, self.senders = character, frozenset({3})
        self.time, self.refusal = inf, ""
        self.taken, self.phrases, self.ended = [], [], []

    def next_time(self, scene) -> float:
        return self.time

    def take(self, words, now):
        self.taken.append((words, now))
        return self.refusal

    def next_phrase(self, scene, now):
        assert now == NOW
        return self.phrases.pop(0) if self.phrases else None

    def finished(self, setup):
        return self.ended

    def clear(self) -> None:
        self.taken.append("cleared")


class PlayedIdling:
    """Scheduler of idle motion with a prepared time."""

    def __init__(self) -> None:
        self.time, self.calls = inf, []

    def next_time(self, scene) -> float:
        return self.time

    def allow(self, now) -> None:
        self.calls.append(("allow", now))

    def forbid(self) -> None:
        self.calls.append("forbid")

    def postpone(self, now) -> None:
        self.calls.append(("postpone", now))

    def plan_next(self, setup):
        return "spell"


def played_planner(known, monkeypatch) -> PlannerState:
    """Planner after two emergency stops."""
    monkeypatch.setattr(module, "SharedScene", PlayedScene)
    monkeypatch.setattr(module, "Talks", PlayedTalks)
    monkeypatch.setattr(module, "IdleScheduler", PlayedIdling)
    monkeypatch.setattr(module, "advance", lambda scene, now: replace(scene, runs=scene.runs + 100))
    properties = LoopProperties(SimpleNamespace(now=lambda: NOW), NO_ACCOMPANIMENT)
    sent = []
    refiner = SimpleNamespace(send_bytes=sent.append, sent=sent)
    beginning = LoopStart(stay(known.robot.skeleton.rest), 2, ())
    rules = Quotas(duration=20.0, depth=8)
    return PlannerState(
        known, lambda setup: ("new", setup), None, refiner, properties, beginning=beginning, rules=rules
    )
