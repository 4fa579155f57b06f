import os
import pty
import sys
import termios
import time
from collections.abc import Callable

import pytest

from kinesic.cli.terminal import pressed_keys

pytestmark = pytest.mark.realtime


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch):
    """Other end of the terminal that standard input is connected to."""
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "r") as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield ours
    os.close(ours)


def await_keys(keys: Callable[[], str]) -> str:
    deadline = time.monotonic() + 5.0
    while time.monotonic() < deadline:
        if pressed := keys():
            return pressed
        time.sleep(0.005)
    return ""


def test_keys_are_read_without_enter_and_terminal_settings_are_restored(terminal: int):
    before = termios.tcgetattr(sys.stdin.fileno())
    with pressed_keys() as keys:
        assert keys() == ""
        os.write(terminal, b" ")
        assert await_keys(keys) == " "
        assert keys() == ""
    assert termios.tcgetattr(sys.stdin.fileno()) == before


def test_no_keys_are_read_without_a_terminal(monkeypatch: pytest.MonkeyPatch):
    with open(os.devnull, encoding="utf-8") as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        with pressed_keys() as keys:
            assert keys() == ""
