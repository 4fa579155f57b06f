"""Child processes: begun, watched and ended."""

import gc
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path

import pytest

from kinesic.child import Child, child_context
from kinesic.expressivity.lexicon.entries import own_gestures

pytestmark = pytest.mark.realtime

CONTEXT = child_context()
MAX_COPIED = 2000  # [kB] of what is preloaded


def answer(line: Connection, word: str) -> None:
    """A child's work: says a word, and then waits for one."""
    line.send(word)
    line.recv()


def tell_group(line: Connection) -> None:
    """A child's work: says in which group of processes it is."""
    line.send(os.getpgrp())


def tell_gestures(line: Connection) -> None:
    """A child's work: says how many gestures have been read, and how many there are."""
    entries = own_gestures().entries
    line.send((sum("_entry" in vars(entry) for entry in entries), len(entries)))


def private_memory() -> int:
    """Return the size [kB] of the pages that no other process shares."""
    return sum(int(size) for size in re.findall(r"Private_\w+: +(\d+)", Path("/proc/self/smaps_rollup").read_text()))


def tell_copied(line: Connection) -> None:
    """Send how many kilobytes a full garbage collection copies."""
    before = private_memory()
    gc.collect()
    line.send(private_memory() - before)


def tell_name(line: Connection) -> None:
    """Send the name that the system shows."""
    line.send(Path("/proc/self/comm").read_text())


def test_a_child_ends_when_its_work_is_done():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, answer, theirs, "ready", name="answer")
    assert ours.recv() == "ready"
    assert child.is_alive
    assert child.wait(0.0) is None
    ours.send("enough")
    assert child.wait() == 0
    assert not child.is_alive


def test_what_a_terminal_signals_is_for_whoever_began_a_child_alone():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_group, theirs)
    assert ours.recv() not in (os.getpgrp(), 0)
    assert child.wait() == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells what forks share")
def test_garbage_collection_copies_nothing_that_forks_share():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_copied, theirs)
    assert ours.recv() < MAX_COPIED
    assert child.wait() == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names of processes are for Linux only")
def test_the_list_of_processes_shows_the_name_of_a_child():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_name, theirs, name="drafter of many words")
    assert ours.recv() == "drafter of many\n"  # as much as the system shows
    assert child.wait() == 0


@pytest.mark.parametrize(("version", "method"), [((3, 11, 0), "spawn"), ((3, 11, 1), "forkserver")])
def test_no_fork_begins_where_other_users_reach_the_server_of_forks(monkeypatch, version: tuple[int, ...], method: str):
    if "forkserver" not in multiprocessing.get_all_start_methods():
        pytest.skip("children are no forks here")
    monkeypatch.setattr(sys, "version_info", version)
    assert child_context().get_start_method() == method


@pytest.mark.skipif(CONTEXT.get_start_method() != "forkserver", reason="children are no forks here")
def test_a_child_begins_with_all_gestures_read():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_gestures, theirs)
    read, there = ours.recv()
    assert read == there > 0
    assert child.wait() == 0


def test_a_child_that_is_killed_closes_its_end_of_the_pipe():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, answer, theirs, "ready")
    assert theirs.closed
    assert ours.recv() == "ready"
    child.kill()
    with pytest.raises(EOFError):
        ours.recv()
    assert child.wait() == -signal.SIGKILL
    child.kill()  # once more does no harm


ORPHAN = """
import os, time
from kinesic.child import Child, child_context

def set_up_for_ever(line):
    line.send(os.getpid())
    while True:
        sum(range(1000))

if __name__ == "__main__":
    context = child_context()
    ours, theirs = context.Pipe()
    child = Child(context, set_up_for_ever, theirs)
    print(ours.recv(), flush=True)
    time.sleep(600.0)
"""


def test_a_child_that_is_busy_ends_with_a_parent_that_is_killed(tmp_path):
    script = tmp_path / "parent.py"
    script.write_text(ORPHAN)
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True) as parent:
        child = int(parent.stdout.readline())
        parent.kill()
    for _ in range(200):
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    os.kill(child, signal.SIGKILL)
    pytest.fail("it goes on alone")


INTERRUPTED = """
import signal, sys, time
from kinesic.child import Child, child_context

signal.signal(signal.SIGINT, signal.default_int_handler)

def work():
    pass

if __name__ == "__main__":
    try:
        Child(child_context("slow_to_import"), work)
        time.sleep(30)
    except KeyboardInterrupt:
        sys.exit(130)
"""


def test_ctrl_c_while_children_are_prepared_leaves_no_traceback(tmp_path):
    (tmp_path / "program.py").write_text(INTERRUPTED)
    (tmp_path / "slow_to_import.py").write_text("import pathlib, time\npathlib.Path('began').touch()\ntime.sleep(1)\n")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    program = subprocess.Popen(
        [sys.executable, "program.py"],
        cwd=tmp_path,
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while not (tmp_path / "began").exists():
        assert program.poll() is None
        time.sleep(0.01)
    os.killpg(program.pid, signal.SIGINT)
    _, errors = program.communicate(timeout=60)
    assert (program.returncode, errors) == (130, "")
