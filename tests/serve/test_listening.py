"""Microphone of the server."""

import asyncio
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

from kinesic.hearing.barge_in import BargeInDecision
from kinesic.hearing.ear import HeardChange
from kinesic.serve import listening
from kinesic.serve.listening import MAX_PLAYED_DURATION, NO_CLIENT, PlayedSamples, hear_people, heard_report
from kinesic.serve.wire.conversing import ConverseRequest, HeardReport
from kinesic.speech.speaker import SAMPLE_RATE, Speaker


class Noise:
    """Source of a few parts of quiet noise."""

    def __init__(self, rate: int, parts: int = 3) -> None:
        self.rate, self.parts, self.is_closed = rate, parts, False

    def read(self, count: int) -> np.ndarray:
        self.parts -= 1
        return np.full(count if self.parts >= 0 else 0, 1e-4, np.float32)

    def close(self) -> None:
        self.is_closed = True


class HearingAll:
    """Fake ear that hears a voice in each part, and keeps what the robot played."""

    played: ClassVar[list[np.ndarray]] = []

    def __init__(self, rate: int) -> None:
        self.count = 0

    def hear(self, heard: np.ndarray, played: np.ndarray | None) -> list[HeardChange]:
        self.count += 1
        HearingAll.played.append(played)
        decision = (BargeInDecision.DUCK, BargeInDecision.YIELD, BargeInDecision.END)[self.count - 1]
        return [HeardChange(decision, 1.0, 0.1 * self.count)]


def listen(
    monkeypatch: pytest.MonkeyPatch, source: Noise, speaker: object, *, converses: bool = True
) -> list[tuple[object, int]]:
    """Run a listener to the end of its source, and return the messages to the session and the mutes."""
    sent: list[tuple[object, int]] = []
    effects = SimpleNamespace(duck=lambda on: sent.append(("duck", on)))
    loop = SimpleNamespace(change_sound=lambda change: change(effects))
    monkeypatch.setattr(listening, "Ear", HearingAll)
    HearingAll.played = []
    session = SimpleNamespace(
        speaker=speaker,
        loop=loop,
        converses=converses,
        converse=lambda message, sender: sent.append((message, sender)),
    )

    async def run() -> None:
        listener = hear_people(session, source)
        await asyncio.to_thread(listener.join)

    asyncio.run(run())
    return sent


def test_voices_in_a_microphone_become_messages_of_a_conversation_that_the_server_begins(monkeypatch):
    source = Noise(16_000)
    sent = [item for item in listen(monkeypatch, source, None) if item[0] != "duck"]
    assert {sender for _, sender in sent} == {NO_CLIENT}
    assert isinstance(sent[0][0], ConverseRequest)
    assert [(message.voice, message.age) for message, _ in sent[1:]] == [(True, 0.1), (False, pytest.approx(0.3))]
    assert source.is_closed


def test_robot_is_muted_while_a_person_speaks_in_a_conversation(monkeypatch):
    sent = listen(monkeypatch, Noise(16_000), None)
    assert [on for kind, on in sent if kind == "duck"] == [True, False]
    assert len(listen(monkeypatch, Noise(16_000), None, converses=False)) == 1


def test_listener_compares_the_microphone_with_the_sound_of_the_loudspeaker(monkeypatch):
    device = SimpleNamespace(open=lambda rate, feed: None, close=lambda: None, latency=0.1)
    speaker = Speaker(lambda: 0.0, device=device)
    listen(monkeypatch, Noise(SAMPLE_RATE), speaker)
    assert all(np.array_equal(played, np.zeros(1411)) for played in HearingAll.played)
    speaker.monitor(np.ones(5, np.float32))
    np.testing.assert_array_equal(speaker._mix_next(4, 0.0), np.zeros(4))
    listen(monkeypatch, Noise(16_000), speaker)
    assert HearingAll.played == [None, None, None]


def test_played_sound_is_taken_in_its_order_and_followed_by_silence():
    queue = PlayedSamples(100)
    queue.add(np.array([1.0, 2.0], np.float32))
    queue.add(np.array([3.0], np.float32))
    np.testing.assert_array_equal(queue.take(2), [1.0, 2.0])
    np.testing.assert_array_equal(queue.take(2), [3.0, 0.0])


def test_played_sound_that_waits_too_long_is_dropped():
    queue = PlayedSamples(100)
    queue.add(np.arange(100, dtype=np.float32))
    assert queue.take(1)[0] == 100 - round(100 * MAX_PLAYED_DURATION)


def test_report_of_a_voice_contains_its_age():
    assert heard_report(HeardChange(BargeInDecision.DUCK, 2.0, 0.25)) == HeardReport(voice=True, age=0.25)
