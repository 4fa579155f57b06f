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
    """The other end of the terminal that standard input is."""
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "r") as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield ours
    os.close(ours)


def soon(keys: Callable[[], str]) -> str:
    limit = time.monotonic() + 5.0
    while time.monotonic() < limit:
        if found := keys():
            return found
        time.sleep(0.005)
    return ""


def test_keys_come_at_once_and_the_terminal_is_as_before(terminal: int):
    before = termios.tcgetattr(sys.stdin.fileno())
    with pressed_keys() as keys:
        assert keys() == ""
        os.write(terminal, b" ")
        assert soon(keys) == " "
        assert keys() == ""
    assert termios.tcgetattr(sys.stdin.fileno()) == before


def test_without_a_terminal_nothing_is_pressed(monkeypatch: pytest.MonkeyPatch):
    with open(os.devnull, encoding="utf-8") as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        with pressed_keys() as keys:
            assert keys() == ""
