"""Signals that end a command, in a process of its own, and terminals that close."""

import os
import pty
import signal
import subprocess
import sys

import pytest

from kinesic.cli.ending_signals import ended_by_signals, leave_closed_terminal

PATIENCE = 30.0  # [s]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_one_is_an_exception_and_a_shell_is_told_which(number: signal.Signals):
    with pytest.raises(SystemExit) as end, ended_by_signals():
        os.kill(os.getpid(), number)
    assert end.value.code == 128 + number
    assert signal.getsignal(number) is signal.SIG_DFL


def test_what_is_ignored_stays_so():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with ended_by_signals():
            os.kill(os.getpid(), signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_the_command_line_ends_so_too():
    program = (
        "import os, signal; from kinesic import cli; cli.kinesic = lambda **_: os.kill(os.getpid(), 15); cli.main()"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=PATIENCE, check=False)
    assert (ended.returncode, ended.stderr) == (143, b"")


def test_a_terminal_that_has_closed_is_left_and_other_streams_stay(capfd: pytest.CaptureFixture[str]):
    ours, theirs = pty.openpty()
    before = os.dup(0)
    os.dup2(theirs, 0)
    try:
        leave_closed_terminal()
        assert os.isatty(0), "it is open"
        os.close(ours)
        leave_closed_terminal()
        assert os.path.sameopenfile(0, theirs) is False
        os.write(0, b"nowhere")
        print("still said", flush=True)  # noqa: T201
    finally:
        os.dup2(before, 0)
        os.close(before)
        os.close(theirs)
    assert capfd.readouterr().out == "still said\n"
