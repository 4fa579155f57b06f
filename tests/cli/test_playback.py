"""Speech and messages during a performance on servos."""

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
SPEECH = Sound.of(8000, np.full(800, 0.5))


class FakeSpeaker:
    """Speaker that records its calls."""

    def __init__(self) -> None:
        self.calls: list[str] = []
        self.start_times: list[float] = []

    def play(self, sound: Sound, at: float) -> None:
        assert sound is SPEECH
        self.start_times.append(at)

    def stop(self) -> None:
        self.calls.append("stop")

    def close(self) -> None:
        self.calls.append("close")


def test_speech_starts_with_the_performance_and_the_speaker_is_closed(monkeypatch: pytest.MonkeyPatch):
    fake = FakeSpeaker()
    monkeypatch.setattr(soundtrack, "sound", lambda plan: SPEECH)
    monkeypatch.setattr(soundtrack, "Speaker", lambda: fake)
    with soundtrack.speak_along(PLAN, playback.warn) as follow:
        for stage, time, scale in [(Stage.HOLD, 0.0, 0.0), (Stage.ACTIVE, 0.02, 1.0), (Stage.ACTIVE, 0.04, 1.0)]:
            follow(Status(stage, clock=7.0 + time, time=time, scale=scale))
        assert fake.start_times == [7.0]
        follow(Status(Stage.STOPPED, clock=8.0, time=0.5, scale=0.0))
    assert fake.calls == ["stop", "close"]


def test_user_action_awaited_by_the_servos_is_printed_once(capsys):
    report = playback.report_waiting()
    for waits in ("nothing", "consent", "consent", "nothing", "confirmation"):
        report(Status(Stage.HOLD, waits=waits))
    assert [line.split(":")[0] for line in capsys.readouterr().err.splitlines()] == [
        "the servos hold",
        "a limb cannot fold and is held",
    ]


def test_performance_without_a_loudspeaker_is_silent(monkeypatch: pytest.MonkeyPatch, capsys):
    def fail_to_open() -> None:
        raise SpeakerError("no device; plug one in")

    monkeypatch.setattr(soundtrack, "sound", lambda plan: SPEECH)
    monkeypatch.setattr(soundtrack, "Speaker", fail_to_open)
    with soundtrack.speak_along(PLAN, playback.warn) as follow:
        follow(Status(Stage.ACTIVE, clock=7.0, time=0.0, scale=1.0))
    assert capsys.readouterr().err == "voice: no sound (no device; plug one in)\n"


def test_no_speaker_is_opened_without_speech(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(soundtrack, "sound", lambda plan: None)
    monkeypatch.setattr(soundtrack, "Speaker", lambda: pytest.fail("opened"))
    with soundtrack.speak_along(PLAN, playback.warn) as follow:
        follow(Status(Stage.ACTIVE, clock=7.0, time=0.0, scale=1.0))


@pytest.mark.parametrize(("time", "index"), [(-1.0, 0), (0.0, 0), (0.02, 2), (99.0, -1)])
def test_face_follows_the_time_of_the_servos_up_to_the_last_command(monkeypatch, time: float, index: int):
    commands = ["first", "second", "third", "last"]
    monkeypatch.setattr("kinesic.cli.playback.commands_with_face", lambda plan, times: commands)
    shown: list[str] = []
    follow = playback.follow_servos(SimpleNamespace(command_times=()), SimpleNamespace(write=shown.append))
    follow(SimpleNamespace(time=time))
    assert shown == [commands[index]]
