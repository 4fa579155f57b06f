"""Recorded realtime conversation, played through the adapter of the example into a robot."""

import base64
import contextlib
import io
import json
import runpy
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest

from kinesic.body.utterance import Script
from kinesic.serve.conversation_requests import conversation_requests
from kinesic.serve.tracks import SoundAndFace, TrackEffects
from kinesic.serve.wire.protocol import read_control
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.speaker import SAMPLE_RATE

from .planning_bench import Planning
from .test_conversing import OWNER, Talk

DELTA_SIZE = 4_800  # [bytes] of one audio delta: 0.1 s
QUESTION, ANSWER = "Where is the nearest lake?", "The nearest lake is only a mile away, behind the old mill."


@pytest.fixture(scope="module")
def adapter():
    with contextlib.redirect_stdout(io.StringIO()):
        return runpy.run_path(str(Path(__file__).parents[2] / "examples" / "13_realtime.py"))


@pytest.fixture(scope="module")
def answer() -> bytes:
    """Return a spoken answer as 16-bit samples at 24 kHz."""
    if why := espeak_fault():
        pytest.skip(why)
    sound = Espeak().say(Script(ANSWER)).sound
    times = np.arange(round(sound.duration * 24_000)) / 24_000
    samples = np.interp(times, np.arange(len(sound.samples)) / sound.rate, sound.samples)
    return (32_000 * samples).astype("<i2").tobytes()


def recording(sound: bytes, *, interrupted: float | None = None) -> list[tuple[float, dict[str, object]]]:
    """Return times [s] and server events of a question and its answer, three times as fast as it sounds."""
    events: list[tuple[float, dict[str, object]]] = [
        (1.0, {"type": "input_audio_buffer.speech_started"}),
        (2.8, {"type": "input_audio_buffer.speech_stopped"}),
        (2.9, {"type": "conversation.item.input_audio_transcription.completed", "transcript": QUESTION}),
        (3.0, {"type": "response.created"}),
        (3.0, {"type": "rate_limits.updated"}),
    ]
    for k in range(0, len(sound), DELTA_SIZE):
        data = base64.b64encode(sound[k : k + DELTA_SIZE]).decode()
        event = {"type": "response.output_audio.delta", "item_id": "item_1", "delta": data}
        events.append((3.5 + k / 144_000, event))
    events.append((events[-1][0], {"type": "response.output_audio.done", "item_id": "item_1"}))
    if interrupted is not None:
        events.append((interrupted, {"type": "input_audio_buffer.speech_started"}))
    return sorted(events, key=lambda pair: pair[0])


def play(talk: Talk, adapter, events: list[tuple[float, dict[str, object]]], until: float) -> None:
    """Send the messages of recorded events to the planner at their times."""
    messages = [(0.0, {"do": "converse"}), *((time, adapter["of_realtime"](event)) for time, event in events)]
    for time, message in messages:
        if message is None:
            continue
        talk.until(time)
        for request in conversation_requests(read_control(json.dumps(message).encode()), OWNER, 0):
            talk.state.execute(request)
        talk.collect()
    talk.until(until)


@pytest.fixture
def talk(make_planning: Callable[..., Planning]) -> Talk:
    return Talk(make_planning(accompaniment=SoundAndFace(face=True, sound=True)))


def names(talk: Talk) -> list[str]:
    return [state for k, state in enumerate(talk.states()) if k == 0 or talk.states()[k - 1] != state]


def test_recorded_realtime_conversation_passes_through_listening_thinking_and_speaking(talk, adapter, answer):
    play(talk, adapter, recording(answer), 10.0)
    assert names(talk) == ["attending", "listening", "thinking", "speaking", "attending"]
    begin = next(time for time, _, message in talk.told if message.get("state") == "speaking")
    end = next(time for time, _, message in reversed(talk.told) if message.get("state") == "attending")
    assert begin == pytest.approx(3.7, abs=0.1)
    assert end - begin == pytest.approx(len(answer) / 48_000, abs=0.1)
    tracks = [track for item in talk.proposals for track in item.tracks.values() if track is not None]
    samples = sum(len(sound.samples) for sound in dict(piece for track in tracks for piece in track.sounds).values())
    assert samples / SAMPLE_RATE == pytest.approx(len(answer) / 48_000, abs=0.01)


def test_mouth_follows_the_loudness_of_a_recorded_answer(talk, adapter, answer):
    play(talk, adapter, recording(answer), 7.0)
    effects, proposals, shown = TrackEffects(face=True), talk.proposals, []
    samples = np.frombuffer(answer, "<i2").astype(float)
    for time in np.arange(0.05, len(samples) / 24_000 - 0.05, 0.02):
        while proposals and proposals[0].now <= 3.7 + time:
            effects.take(proposals.pop(0).tracks)
        first = round(24_000 * time)
        loud = np.sqrt(np.mean(samples[first - 480 : first + 480] ** 2))
        shown.append((effects.face(3.7 + time).get("26", 0.0), loud))
    assert np.corrcoef(np.array(shown).T)[0, 1] > 0.7


def test_interrupted_recorded_answer_is_truncated_at_the_heard_position(talk, adapter, answer):
    play(talk, adapter, recording(answer, interrupted=5.0), 8.0)
    assert names(talk)[:5] == ["attending", "listening", "thinking", "speaking", "interrupted"]
    (event,) = [event for _, _, told in talk.told if (event := adapter["to_realtime"](told)) is not None]
    assert event["type"] == "conversation.item.truncate"
    assert event["item_id"] == "item_1"
    assert event["audio_end_ms"] == pytest.approx(1000 * (5.0 + 0.75 - 3.7), abs=60)


def test_server_events_without_a_meaning_for_the_robot_are_ignored(adapter):
    assert adapter["of_realtime"]({"type": "session.updated"}) is None
    assert adapter["to_realtime"]({"told": "conversing", "state": "idle"}) is None
    with pytest.raises(ValueError, match="base64"):
        read_control(msgspec.json.encode({"do": "sound", "id": "a", "data": "%"}))
