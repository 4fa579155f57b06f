"""Stages of a verb: shown on a terminal, and nowhere else."""

import os
import pty
import re
import sys
import time

import pytest

from kinesic.cli.progress import share_of, show_stages

PATIENCE = 10.0  # [s]


def test_a_pipe_is_told_nothing(capfd: pytest.CaptureFixture[str]):
    with show_stages() as stage:
        stage("planning")
        share_of(stage, "drawing")(0.5)
    assert capfd.readouterr() == ("", "")


def test_a_terminal_sees_each_stage_and_a_share_of_it(monkeypatch: pytest.MonkeyPatch):
    for name, value in (("TERM", "xterm"), ("NO_COLOR", "1"), ("COLUMNS", "80")):
        monkeypatch.setenv(name, value)
    ours, theirs = pty.openpty()
    os.set_blocking(ours, False)
    with os.fdopen(theirs, "w", buffering=1) as stderr, monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", stderr)
        with show_stages() as stage:
            stage("plan[b]ning")
            assert comes(ours, "plan[b]ning")
            drawing = share_of(stage, "drawing")
            drawing(0.5)
            assert comes(ours, "drawing \u2501{20} ")
            drawing(1.0)
            assert comes(ours, "drawing \u2501{40}")
    os.close(ours)


def comes(terminal: int, pattern: str) -> bool:
    """Whether a terminal comes to show a text."""
    shown, limit = b"", time.monotonic() + PATIENCE
    while time.monotonic() < limit:
        try:
            shown += os.read(terminal, 65536)
        except BlockingIOError:
            time.sleep(0.01)
        if re.search(pattern.replace("[b]", r"\[b\]"), shown.decode(errors="replace")):
            return True
    return False
