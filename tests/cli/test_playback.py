"""Speech and messages during a performance on servos."""

import io
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.utterance import Sound
from kinesic.cli import playback
from kinesic.cli.screen.console import Console
from kinesic.controller import soundtrack
from kinesic.face.display import DisplayError
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
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


def test_each_user_action_for_which_the_servos_wait_is_printed_once(capsys):
    report = playback.report_waiting()
    for waits in ("nothing", "consent", "consent", "nothing", "confirmation"):
        report(Status(Stage.HOLD, waits=waits))
    assert [line.split(":")[0] for line in capsys.readouterr().err.splitlines()] == [
        "the servos hold",
        "a limb cannot fold and is held",
    ]


def test_performance_without_a_loudspeaker_continues_with_a_warning(monkeypatch: pytest.MonkeyPatch, capsys):
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
def test_face_window_follows_the_time_of_the_servos_up_to_the_last_command(monkeypatch, time: float, index: int):
    commands = ["first", "second", "third", "last"]
    monkeypatch.setattr("kinesic.cli.playback.commands_with_face", lambda plan, times: commands)
    shown: list[str] = []
    follow = playback.follow_servos(SimpleNamespace(command_times=()), SimpleNamespace(write=shown.append))
    follow(SimpleNamespace(time=time))
    assert shown == [commands[index]]


def test_servo_status_is_ignored_without_a_face_window():
    assert playback.follow_servos(PLAN, None)(Status(Stage.ACTIVE, time=1.0)) is None


def test_face_window_gets_commands_with_the_times_of_the_plan(monkeypatch):
    asked: list[object] = []
    monkeypatch.setattr(playback, "commands_with_face", lambda plan, times: asked.extend((plan, times)) or ["only"])
    plan = SimpleNamespace(command_times=(0.0,))
    playback.follow_servos(plan, SimpleNamespace(write=lambda command: None))
    assert asked == [plan, (0.0,)]


class FakePreview:
    """Test double of a face window that records its options."""

    def __init__(self, robot: object, *, look: object, windowed: bool) -> None:
        self.opened = (robot, look, windowed)
        self.is_open = False

    def __enter__(self) -> None:
        self.is_open = True

    def __exit__(self, *_: object) -> None:
        self.is_open = False


def test_face_window_shows_the_film_of_the_body_and_closes_at_the_end(monkeypatch, capsys):
    monkeypatch.setattr(playback, "has_display", lambda: True)
    monkeypatch.setattr(playback, "Preview", FakePreview)
    with playback.preview_window("robot", requested=True, body_film=Path("body.mp4")) as preview:
        assert preview.is_open
        robot, look, windowed = preview.opened
        assert (robot, look.beside, windowed) == ("robot", Path("body.mp4"), True)
    assert not preview.is_open
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", f"{playback.KEY_HELP}\n")


@pytest.mark.parametrize(("requested", "note"), [(False, ""), (True, "face: no display for a window")])
def test_face_window_opens_only_if_it_is_requested_and_a_display_exists(monkeypatch, capsys, requested, note):
    monkeypatch.setattr(playback, "has_display", lambda: not requested)
    monkeypatch.setattr(playback, "Preview", lambda *_, **__: pytest.fail("opened"))
    with playback.preview_window("robot", requested=requested) as preview:
        assert preview is None
    captured = capsys.readouterr()
    assert (captured.out, captured.err.split(";")[0].strip()) == ("", note)


def test_face_window_that_fails_to_open_raises_a_configuration_error(monkeypatch):
    def fail_to_open(*_: object, **__: object) -> None:
        raise DisplayError("no GLX")

    monkeypatch.setattr(playback, "has_display", lambda: True)
    monkeypatch.setattr(playback, "Preview", fail_to_open)
    with pytest.raises(ConfigError, match="no GLX"), playback.preview_window("robot", requested=True):
        pass


@pytest.mark.parametrize(("voice", "opens"), [(SPEECH, True), (SPEECH, False), (None, True)])
def test_face_window_plays_the_performance_with_its_voice_if_there_is_a_speaker(monkeypatch, voice, opens):
    fake, played = FakeSpeaker(), []

    @contextmanager
    def open_speaker(warn: Callable[[str], None]) -> Iterator[FakeSpeaker | None]:
        fake.calls.append("open")
        yield fake if opens else None
        fake.calls.append("close")

    monkeypatch.setattr(playback, "commands_with_face", lambda plan, times: [plan, times])
    monkeypatch.setattr(playback, "sound", lambda plan: voice)
    monkeypatch.setattr(playback, "open_speaker", open_speaker)
    monkeypatch.setattr(playback, "monotonic", lambda: 7.0)
    monkeypatch.setattr(playback, "pace_commands", lambda commands: ("paced", *commands))
    monkeypatch.setattr(playback, "play", lambda *arguments: played.append(arguments))
    plan = SimpleNamespace(command_times=(0.0,))
    playback.play_whole(plan, "preview")
    assert played == [(("paced", plan, (0.0,)), "preview")]
    assert fake.start_times == ([7.0] if voice and opens else [])
    assert fake.calls == (["open", "close"] if voice else [])


@pytest.fixture
def servo_runs(monkeypatch) -> list[SimpleNamespace]:
    """List the performances on servos, each of which reports two statuses."""
    runs: list[SimpleNamespace] = []

    @contextmanager
    def catch_interrupts() -> Iterator[Callable[[], bool]]:
        yield lambda: True

    @contextmanager
    def pressed_keys() -> Iterator[Callable[[], str]]:
        yield lambda: " "

    def perform_live(performance: object, servos: object, *, requested: Callable, shown: Callable) -> SimpleNamespace:
        for waits in ("nothing", "consent"):
            shown(Status(Stage.HOLD, waits=waits))
        runs.append(SimpleNamespace(performance=performance, servos=servos, request=requested(), notes=("lost",)))
        return runs[-1]

    monkeypatch.setattr(soundtrack, "sound", lambda plan: None)
    monkeypatch.setattr(playback, "catch_interrupts", catch_interrupts)
    monkeypatch.setattr(playback, "pressed_keys", pressed_keys)
    monkeypatch.setattr(playback, "perform_live", perform_live)
    monkeypatch.setattr(playback, "Servos", lambda robot, ports, *, settings, log: (robot, ports, settings, log))
    monkeypatch.setattr(playback, "warn_of_lost_events", lambda notes: playback.warn(f"notes: {notes}"))
    return runs


@pytest.mark.parametrize("quiet", [False, True])
def test_servo_performance_writes_an_event_log_and_passes_statuses_to_the_listener(servo_runs, capsys, tmp_path, quiet):
    performance = SimpleNamespace(plan=SimpleNamespace(setup=SimpleNamespace(robot="robot", policy=None)))
    heard: list[Status] = []
    run = playback.perform_on_servos(performance, {"left": Path("port")}, tmp_path, quiet=quiet, listener=heard.append)
    assert servo_runs == [run]
    assert (run.performance, run.request) == (performance, "stop")
    assert run.servos == ("robot", {"left": Path("port")}, DEFAULT_SETTINGS, tmp_path / "events.jsonl")
    assert [status.waits for status in heard] == ["nothing", "consent"]
    captured = capsys.readouterr()
    help_lines = [] if quiet else [playback.SERVO_KEY_HELP]
    assert captured.out == ""
    assert captured.err.splitlines() == [*help_lines, playback.WAIT_MESSAGES["consent"], "notes: ('lost',)"]


@pytest.mark.parametrize(
    ("keys", "interrupted", "request_", "detached"),
    [
        ("a b", True, "stop", False),
        (" \n", False, "stop", False),
        ("\n", True, "resume", False),
        ("a\r", False, "resume", False),
        ("a", False, "go on", False),
        ("", True, "end", True),
    ],
)
def test_stop_key_has_priority_over_enter_and_enter_over_an_interrupt(
    monkeypatch, keys, interrupted, request_, detached
):
    detachments: list[bool] = []
    monkeypatch.setattr(playback, "detach_closed_terminal", lambda: detachments.append(True))
    assert playback._make_request_reader(lambda: keys, lambda: interrupted)() == request_
    assert detachments == [True] * detached


def test_report_and_log_of_a_servo_run_replace_those_of_the_twin(monkeypatch, tmp_path):
    rewritten: list[object] = []
    run = SimpleNamespace(performance=SimpleNamespace(plan=SimpleNamespace(setup=SimpleNamespace(robot="robot"))))
    written = SimpleNamespace(report=tmp_path / "report.json")
    (tmp_path / "servos.npz").write_text("old")
    monkeypatch.setattr(playback, "with_live", lambda data, live: {**data, "live": live})
    monkeypatch.setattr(playback, "add_identification", lambda data, lesson: {**data, "learned": lesson})
    monkeypatch.setattr(playback, "rewrite", lambda *arguments: rewritten.extend(arguments))
    monkeypatch.setattr(playback, "live_log", lambda live: ("log", live))
    monkeypatch.setattr(playback, "write_log", lambda log, robot, path: path.write_text(f"{log[0]} of {robot}"))
    data, log = playback.write_servo_run(run, {"ok": True}, written, "lesson")
    assert data == {"ok": True, "live": run, "learned": "lesson"}
    assert rewritten == [written, run.performance, data]
    assert log == tmp_path / "servos.npz"
    assert log.read_text() == "log of robot"


@pytest.mark.parametrize(
    ("quiet", "terminal", "shows"), [(False, True, True), (True, True, False), (False, False, False)]
)
def test_status_line_is_shown_on_terminals_only_and_disappears(monkeypatch, quiet, terminal, shows):
    screen = io.StringIO()
    monkeypatch.setattr(playback, "error_console", lambda: Console(screen, 100, is_terminal=terminal))
    with playback._open_status_line(quiet) as show:
        show(Status(Stage.HOLD, time=1.5, volts=12.0))
        deadline = time.monotonic() + 10.0
        while shows and "1.50 s" not in screen.getvalue() and time.monotonic() < deadline:
            time.sleep(0.01)
    assert ("1.50 s" in screen.getvalue()) is shows
    assert ("\x1b[2K" in screen.getvalue()) is shows  # the line is erased


def test_status_line_counts_silent_servos_if_there_are_any():
    status = {"time": 1.25, "energised": 26, "hottest": 41.4, "volts": 11.96}
    line = "hold        1.25 s  26 servos with torque  41 C  12.0 V"
    assert playback._format_status(Status(Stage.HOLD, **status)) == line
    assert playback._format_status(Status(Stage.HOLD, silent=2, **status)) == f"{line}  2 silent"
