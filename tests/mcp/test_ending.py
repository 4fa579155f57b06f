"""The server that `kinesic mcp` starts ends with it, however that ends."""

import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from time import monotonic, sleep

import pytest

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'"),
    pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs the /proc of Linux"),
]

MAX_WAIT = 12.0  # [s] less than a server is given before it is killed


@pytest.mark.parametrize("end", ["input ends", "killed"])
def test_the_server_of_the_tools_ends_with_them(tmp_path: Path, end: str):
    command = [sys.executable, "-m", "kinesic", "mcp", "--voice", "durations"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, cwd=tmp_path) as tools:
        assert tools.stdin is not None
        server = wait_for(lambda: find_server(tools.pid))
        wait_for(lambda: len(children_of(server)))  # its planner begins
        if end == "killed":
            tools.kill()
        tools.stdin.close()
        wait_for(lambda: not is_running(server))


def find_server(process: int) -> int:
    """Return the child process that serves, or 0."""
    serving = (child for child in children_of(process) if b"--listen" in Path(f"/proc/{child}/cmdline").read_bytes())
    return next(serving, 0)


def children_of(process: int) -> list[int]:
    """Return the child processes of a process."""
    tasks = Path(f"/proc/{process}/task").iterdir()
    return [int(child) for task in tasks for child in (task / "children").read_text().split()]


def is_running(process: int) -> bool:
    """Return whether a process has not ended."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_for(condition: Callable[[], int]) -> int:
    """Wait until a condition holds."""
    until = monotonic() + MAX_WAIT
    while not (found := condition()):
        assert monotonic() < until
        sleep(0.05)
    return found
