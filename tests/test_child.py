"""Child processes: start, monitoring and end."""

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
from kinesic.expressivity.lexicon.entries import builtin_gestures

pytestmark = pytest.mark.realtime

CONTEXT = child_context()
MAX_COPIED = 2000  # [kB] largest shared memory that a garbage collection may copy


def answer(line: Connection, word: str) -> None:
    """Send a word to the parent and wait for an answer, in a child process."""
    line.send(word)
    line.recv()


def tell_group(line: Connection) -> None:
    """Send the parent this child's process group."""
    line.send(os.getpgrp())


def tell_gestures(line: Connection) -> None:
    """Send the parent the numbers of loaded gestures and of all gestures."""
    entries = builtin_gestures().entries
    line.send((sum("_entry" in vars(entry) for entry in entries), len(entries)))


def private_memory() -> int:
    """Return the size [kB] of the pages that no other process shares."""
    return sum(int(size) for size in re.findall(r"Private_\w+: +(\d+)", Path("/proc/self/smaps_rollup").read_text()))


def tell_copied(line: Connection) -> None:
    """Send the parent the memory [kB] that a full garbage collection copies."""
    before = private_memory()
    gc.collect()
    line.send(private_memory() - before)


def tell_name(line: Connection) -> None:
    """Send the parent the process name that the system shows for this child."""
    line.send(Path("/proc/self/comm").read_text())


def test_child_process_ends_when_its_function_returns():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, answer, theirs, "ready", name="answer")
    assert ours.recv() == "ready"
    assert child.is_alive
    assert child.wait(0.0) is None
    ours.send("enough")
    assert child.wait() == 0
    assert not child.is_alive


def test_child_process_has_a_process_group_of_its_own():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_group, theirs)
    assert ours.recv() not in (os.getpgrp(), 0)
    assert child.wait() == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells what forks share")
def test_garbage_collection_in_a_child_copies_few_shared_memory_pages():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_copied, theirs)
    assert ours.recv() < MAX_COPIED
    assert child.wait() == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names of processes are for Linux only")
def test_process_list_of_the_system_shows_the_name_of_a_child_process():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_name, theirs, name="drafter of many words")
    assert ours.recv() == "drafter of many\n"  # length shown by the system
    assert child.wait() == 0


@pytest.mark.parametrize(("version", "method"), [((3, 11, 0), "spawn"), ((3, 11, 1), "forkserver")])
def test_child_processes_use_the_fork_server_only_from_python_3_11_1(
    monkeypatch, version: tuple[int, ...], method: str
):
    if "forkserver" not in multiprocessing.get_all_start_methods():
        pytest.skip("children are no forks here")
    monkeypatch.setattr(sys, "version_info", version)
    assert child_context().get_start_method() == method


@pytest.mark.skipif(CONTEXT.get_start_method() != "forkserver", reason="children are no forks here")
def test_child_process_starts_with_the_lexicon_loaded():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, tell_gestures, theirs)
    read, there = ours.recv()
    assert read == there > 0
    assert child.wait() == 0


def test_killed_child_process_closes_its_pipe_end():
    ours, theirs = CONTEXT.Pipe()
    child = Child(CONTEXT, answer, theirs, "ready")
    assert theirs.closed
    assert ours.recv() == "ready"
    child.kill()
    with pytest.raises(EOFError):
        ours.recv()
    assert child.wait() == -signal.SIGKILL
    child.kill()  # a second call has no effect


ORPHAN_PROGRAM = """
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


def test_busy_child_ends_when_its_parent_is_killed(tmp_path):
    script = tmp_path / "parent.py"
    script.write_text(ORPHAN_PROGRAM)
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


INTERRUPTED_PROGRAM = """
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


def test_ctrl_c_during_child_startup_prints_no_traceback(tmp_path):
    (tmp_path / "program.py").write_text(INTERRUPTED_PROGRAM)
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
