"""Progress display of verbs on terminals and in pipes."""

import os
import pty
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

import pytest

from kinesic.cli import gestures, plan, validate
from kinesic.cli.progress import Progress, Stage, show_stages, show_steps, stage_progress

TERMINAL_TIMEOUT = 10.0  # [s]


def test_progress_is_not_shown_on_a_pipe(capfd: pytest.CaptureFixture[str]):
    with show_stages() as stage:
        stage("planning")
        stage_progress(stage, "drawing")(0.5)
    assert capfd.readouterr() == ("", "")


def test_terminal_shows_each_stage_with_its_progress(monkeypatch: pytest.MonkeyPatch):
    for name, value in (("TERM", "xterm"), ("NO_COLOR", "1"), ("COLUMNS", "80")):
        monkeypatch.setenv(name, value)
    ours, theirs = pty.openpty()
    os.set_blocking(ours, False)
    with os.fdopen(theirs, "w", buffering=1) as stderr, monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", stderr)
        with show_stages() as stage:
            stage("plan[b]ning")
            assert appears(ours, r"plan\[b\]ning")
            drawing = stage_progress(stage, "drawing")
            drawing(0.5)
            assert appears(ours, r"drawing \[#{15}\.{15}\] 0:00:0")
            drawing(1.0)
            assert appears(ours, r"drawing \[#{30}\]")
    os.close(ours)


def test_progress_line_shows_the_count_then_the_elapsed_time_then_the_note_after_the_bar():
    progress = Progress("faces", fraction=0.25, count="3/12", note="1 failed", start=100.0)
    assert progress.line(3825.9) == f"faces [{'#' * 8}{'.' * 22}] 3/12 1:02:05 1 failed"


def test_progress_bar_shows_a_moving_marker_if_the_duration_is_unknown():
    bars = [Progress("planning", start=0.0).line(time).split()[1] for time in (0.0, 1.0, 2.4, 2.5)]
    assert [bar.index("#") - 1 for bar in bars] == [0, 10, 24, 0]
    assert {bar.count("#") for bar in bars} == {6}


def test_terminal_shows_the_number_of_completed_steps(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "80")
    ours, theirs = pty.openpty()
    os.set_blocking(ours, False)
    with os.fdopen(theirs, "w", buffering=1) as stderr, monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", stderr)
        with show_steps("scanning", 2) as step:
            step("one note")
            assert appears(ours, r"scanning \[#{15}\.{15}\] 1/2 0:00:0. one note")
    os.close(ours)


def appears(terminal: int, pattern: str) -> bool:
    """Return whether a pattern appears on a terminal in time."""
    shown, deadline = b"", time.monotonic() + TERMINAL_TIMEOUT
    while time.monotonic() < deadline:
        try:
            shown += os.read(terminal, 65536)
        except BlockingIOError:
            time.sleep(0.01)
        if re.search(pattern, shown.decode(errors="replace")):
            return True
    return False


@pytest.mark.parametrize(
    ("module", "arguments", "stage"),
    [
        (gestures, ("gestures", "list"), "reading the gestures"),
        (plan, ("plan", "hello.txt", "--to", "bml"), "writing BML"),
        (plan, ("say", "Hello.", "--to", "bml"), "writing BML"),
        (validate, ("validate", "empty"), "reading the robot"),
    ],
    ids=lambda value: value.__name__ if isinstance(value, ModuleType) else None,
)
def test_verbs_that_take_long_report_their_first_stage(kinesic, tmp_path, monkeypatch, module, arguments, stage):
    stages: list[str] = []

    @contextmanager
    def record() -> Iterator[Stage]:
        yield lambda name, fraction=None: stages.append(name)

    monkeypatch.setattr(module, "show_stages", record)
    (tmp_path / "hello.txt").write_text("Hello.")
    (tmp_path / "empty").mkdir()
    assert kinesic(*arguments).code == 0
    assert stages == [stage]
