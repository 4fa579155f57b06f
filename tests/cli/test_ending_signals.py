"""Signals that end a command, and closed terminals."""

import os
import pty
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from kinesic.cli import ending_signals
from kinesic.cli.ending_signals import detach_closed_terminal, exit_at_once_on_interrupt, exit_on_signals

PROCESS_TIMEOUT = 30.0  # [s]
NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_termination_signal_raises_system_exit_with_its_exit_code(number: signal.Signals):
    with pytest.raises(SystemExit) as end, exit_on_signals():
        os.kill(os.getpid(), number)
    assert end.value.code == 128 + number
    assert signal.getsignal(number) is signal.SIG_DFL


def test_ignored_hangup_signal_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with exit_on_signals():
            os.kill(os.getpid(), signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_command_line_exits_with_143_on_sigterm():
    program = (
        "import os, signal; from kinesic import cli; cli.kinesic = lambda **_: os.kill(os.getpid(), 15); cli.main()"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=PROCESS_TIMEOUT, check=False)
    assert (ended.returncode, ended.stderr) == (143, b"")


def test_ctrl_c_prints_one_line_and_leaves_no_folder(kinesic, tmp_path, monkeypatch: pytest.MonkeyPatch):
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("kinesic.report.output.write_log", stop)  # while the report is being written
    ended = kinesic("perform", "-", "--no-film", stdin=NOD)
    assert (ended.code, ended.out, ended.err) == (130, "", "kinesic: stopped\n")
    assert list(tmp_path.iterdir()) == []


INTERRUPTED_PROGRAMS = {
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


@pytest.mark.parametrize("program", INTERRUPTED_PROGRAMS.values(), ids=INTERRUPTED_PROGRAMS)
def test_ctrl_c_during_an_import_prints_one_line(program: str):
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=PROCESS_TIMEOUT, check=False)
    assert (ended.returncode, ended.stderr) == (130, b"kinesic: stopped\n")


def test_ctrl_c_ignored_by_the_caller_stays_ignored_during_imports():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with exit_at_once_on_interrupt():
            assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_standard_input_is_redirected_to_the_null_device_only_after_its_terminal_closed(
    capfd: pytest.CaptureFixture[str],
):
    ours, theirs = pty.openpty()
    before = os.dup(0)
    os.dup2(theirs, 0)
    try:
        detach_closed_terminal()
        assert os.isatty(0), "the terminal is open"
        os.close(ours)
        detach_closed_terminal()
        assert os.path.sameopenfile(0, theirs) is False
        os.write(0, b"discarded")
        print("still printed", flush=True)  # noqa: T201
    finally:
        os.dup2(before, 0)
        os.close(before)
        os.close(theirs)
    assert capfd.readouterr().out == "still printed\n"


def test_signal_module_imports_no_slow_modules():
    """Import the module alone in a separate process."""
    file = Path(ending_signals.__file__)
    program = "import runpy, sys; before = {*sys.modules}; runpy.run_path(sys.argv[1]); print(*{*sys.modules} - before)"
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", program, str(file)], capture_output=True, text=True, check=True
    )
    assert {"signal", "threading"} <= {*done.stdout.split()}
    assert {"dataclasses", "pathlib", "inspect", "click", "kinesic"}.isdisjoint(done.stdout.split())
