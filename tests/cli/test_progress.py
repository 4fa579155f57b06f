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
from kinesic.cli.progress import Stage, show_stages, stage_progress

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
            assert appears(ours, "plan[b]ning")
            drawing = stage_progress(stage, "drawing")
            drawing(0.5)
            assert appears(ours, "drawing \u2501{20} ")
            drawing(1.0)
            assert appears(ours, "drawing \u2501{40}")
    os.close(ours)


def appears(terminal: int, pattern: str) -> bool:
    """Return whether a pattern appears on a terminal in time."""
    shown, deadline = b"", time.monotonic() + TERMINAL_TIMEOUT
    while time.monotonic() < deadline:
        try:
            shown += os.read(terminal, 65536)
        except BlockingIOError:
            time.sleep(0.01)
        if re.search(pattern.replace("[b]", r"\[b\]"), shown.decode(errors="replace")):
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
def test_slow_commands_report_their_first_stage(kinesic, tmp_path, monkeypatch, module, arguments, stage):
    stages: list[str] = []

    @contextmanager
    def record() -> Iterator[Stage]:
        yield lambda name, fraction=None: stages.append(name)

    monkeypatch.setattr(module, "show_stages", record)
    (tmp_path / "hello.txt").write_text("Hello.")
    (tmp_path / "empty").mkdir()
    assert kinesic(*arguments).code == 0
    assert stages == [stage]
