"""The server started by `kinesic mcp` always ends with it."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from .tool_servers import children_of, find_server, is_running, wait_for

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.soak,  # test_stop and the token tests end servers in both ways too
    pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'"),
    pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs the /proc of Linux"),
]


@pytest.mark.parametrize("end", ["input ends", "killed"])
def test_robot_server_started_by_the_mcp_server_ends_when_the_mcp_server_ends(tmp_path: Path, end: str):
    command = [sys.executable, "-m", "kinesic", "mcp", "--voice", "durations"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, cwd=tmp_path) as tools:
        assert tools.stdin is not None
        server = wait_for(lambda: find_server(tools.pid))
        wait_for(lambda: len(children_of(server)))  # the planner process starts
        if end == "killed":
            tools.kill()
        tools.stdin.close()
        wait_for(lambda: not is_running(server))
