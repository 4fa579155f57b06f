"""Start of `kinesic mcp` if the robot's server starts late or never."""

import gc
import json
import subprocess
import sys
from concurrent.futures import Future
from importlib.util import find_spec
from pathlib import Path

import pytest

from kinesic.cli.live.mcp import load_setup
from kinesic.cli.options import Planning

pytestmark = pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'")

CLIENT_INFO = {"name": "test", "version": "1"}
CLIENT_HELLO = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": CLIENT_INFO}


@pytest.mark.soak  # starts two processes
def test_mcp_server_answers_with_the_start_error_of_the_robot_server_and_exits_with_2(tmp_path: Path):
    (tmp_path / "wrong.toml").write_text("targets = 7")
    command = [sys.executable, "-m", "kinesic", "mcp", "--targets", "wrong.toml"]
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with subprocess.Popen(command, cwd=tmp_path, text=True, **pipes) as tools:

        def ask(number: int, method: str, **parameters: object) -> dict:
            question = {"jsonrpc": "2.0", "id": number, "method": method, "params": parameters}
            print(json.dumps(question), file=tools.stdin, flush=True)
            return json.loads(tools.stdout.readline())["result"]

        assert ask(1, "initialize", **CLIENT_HELLO)["serverInfo"]["name"] == "kinesic"
        print('{"jsonrpc": "2.0", "method": "notifications/initialized"}', file=tools.stdin, flush=True)
        assert "stop" in {tool["name"] for tool in ask(2, "tools/list")["tools"]}
        stopped = ask(3, "tools/call", name="stop", arguments={})
        assert stopped["isError"]
        tools.stdin.close()
        lines = tools.stderr.read().splitlines()
    assert tools.returncode == 2
    assert len(lines) == 1, lines
    assert lines[0].startswith("kinesic: the server of the robot does not start: ")
    assert "wrong.toml" in lines[0]
    assert lines[0].removeprefix("kinesic: ") in stopped["content"][0]["text"]


def test_setup_loaded_by_the_mcp_server_is_excluded_from_garbage_collection():
    opened: Future[object] = Future()
    opened.set_result(None)
    before = gc.get_freeze_count()
    setup = load_setup(Planning("upper22", "neutral", {}), opened)  # freezes the heap for good, as conftest does
    assert gc.get_freeze_count() > before
    assert setup.robot.name == "upper22"
    assert not any(each is setup for each in gc.get_objects())
