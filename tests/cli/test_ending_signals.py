"""Signals that end a command, in a process of its own, and terminals that close."""

import os
import pty
import signal
import subprocess
import sys

import pytest

from kinesic.cli.ending_signals import ended_by_signals, ended_on_the_spot, leave_closed_terminal

PATIENCE = 30.0  # [s]
NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'


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


def test_ctrl_c_is_one_line_and_leaves_no_folder(kinesic, tmp_path, monkeypatch: pytest.MonkeyPatch):
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("kinesic.report.output.write_log", stop)  # while the folder of the report is being filled
    ended = kinesic("perform", "-", "--no-film", stdin=NOD)
    assert (ended.code, ended.out, ended.err) == (130, "", "kinesic: stopped\n")
    assert list(tmp_path.iterdir()) == []


IMPORTING = {
    "a verb": (
        "import os, sys; from kinesic import cli; from kinesic.cli import options\n"
        "options.import_at_once = lambda name: os.kill(os.getpid(), 2)\n"
        "sys.argv = ['kinesic', 'robots', 'list']\n"
        "cli.main()"
    ),
    "the command line": (
        "import os, sys\n"
        "class Stop:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'kinesic.cli.verbs': os.kill(os.getpid(), 2)\n"
        "sys.meta_path.insert(0, Stop())\n"
        "import kinesic.cli"
    ),
}


@pytest.mark.parametrize("program", IMPORTING.values(), ids=IMPORTING)
def test_ctrl_c_in_an_import_is_one_line_and_not_swallowed(program: str):
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=PATIENCE, check=False)
    assert (ended.returncode, ended.stderr) == (130, b"kinesic: stopped\n")


def test_ctrl_c_that_is_ignored_stays_so_while_a_verb_is_imported():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with ended_on_the_spot():
            assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


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
