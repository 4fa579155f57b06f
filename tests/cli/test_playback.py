"""A performance on servos that is heard."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.cli import playback
from kinesic.controller import soundtrack
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.speech.loudspeaker import SpeakerError

PLAN = SimpleNamespace()
SAID = Sound.of(8000, np.full(800, 0.5))


class Fake:
    """A speaker that keeps what it is asked."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.begun: list[float] = []

    def play(self, sound: Sound, at: float) -> None:
        assert sound is SAID
        self.begun.append(at)

    def stop(self) -> None:
        self.asked.append("stop")

    def close(self) -> None:
        self.asked.append("close")


def test_what_is_said_begins_with_the_performance_and_the_speaker_is_let_go(monkeypatch: pytest.MonkeyPatch):
    fake = Fake()
    monkeypatch.setattr(soundtrack, "sound", lambda plan: SAID)
    monkeypatch.setattr(soundtrack, "Speaker", lambda: fake)
    with soundtrack.speak_along(PLAN, playback.warn) as said:
        for stage, time, scale in [(Stage.HOLD, 0.0, 0.0), (Stage.ACTIVE, 0.02, 1.0), (Stage.ACTIVE, 0.04, 1.0)]:
            said(Status(stage, clock=7.0 + time, time=time, scale=scale))
        assert fake.begun == [7.0]
        said(Status(Stage.STOPPED, clock=8.0, time=0.5, scale=0.0))
    assert fake.asked == ["stop", "close"]


def test_what_is_waited_for_is_said_once(capsys):
    tell = playback.tell_waiting()
    for waits in ("nothing", "consent", "consent", "nothing", "confirmation"):
        tell(Status(Stage.HOLD, waits=waits))
    assert [line.split(":")[0] for line in capsys.readouterr().err.splitlines()] == [
        "the servos hold",
        "a limb cannot fold, and is held",
    ]


def test_without_a_loudspeaker_it_is_performed_in_silence(monkeypatch: pytest.MonkeyPatch, capsys):
    def none() -> None:
        raise SpeakerError("no device; plug one in")

    monkeypatch.setattr(soundtrack, "sound", lambda plan: SAID)
    monkeypatch.setattr(soundtrack, "Speaker", none)
    with soundtrack.speak_along(PLAN, playback.warn) as said:
        said(Status(Stage.ACTIVE, clock=7.0, time=0.0, scale=1.0))
    assert capsys.readouterr().err == "voice: not heard (no device; plug one in)\n"


def test_nothing_is_opened_where_nothing_is_said(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(soundtrack, "sound", lambda plan: None)
    monkeypatch.setattr(soundtrack, "Speaker", lambda: pytest.fail("opened"))
    with soundtrack.speak_along(PLAN, playback.warn) as said:
        said(Status(Stage.ACTIVE, clock=7.0, time=0.0, scale=1.0))
