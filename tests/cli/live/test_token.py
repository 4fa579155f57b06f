"""Secrecy of a server's token in process lists and output."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path

import pytest

from kinesic.cli.live.token import _without_token
from kinesic.client import Client

from ...mcp.tool_servers import command_lines, find_server, is_running, wait_for

pytestmark = pytest.mark.realtime

TOKEN = "open-sesame-1234"
MAX_WAIT = 20.0  # [s] longest wait for a message or the end of the server
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="cut"><head id="h" lexeme="NOD" start="0"/></bml>'
KINESIC = (sys.executable, "-m", "kinesic")
needs_proc = pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="no /proc: arguments cannot be seen here")


@contextmanager
def running(
    *arguments: str, until: str, **environment: str
) -> Iterator[tuple[subprocess.Popen[str], re.Match[str], str]]:
    """Run a verb until its output matches, and yield process and output."""
    inherited = {name: value for name, value in os.environ.items() if name != "KINESIC_TOKEN"}
    with subprocess.Popen(
        [*KINESIC, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=inherited | environment,
    ) as process:
        try:
            output = ""
            for line in process.stderr:
                output += line
                if match := re.search(until, line):
                    break
            else:
                raise AssertionError(output)
            yield process, match, output
        finally:
            process.kill()


@pytest.fixture
def token_file(tmp_path: Path) -> Path:
    path = tmp_path / "token"
    path.touch(0o600)
    path.write_text(f"{TOKEN}\n")
    return path


TOKEN_SOURCES: Mapping[str, tuple[tuple[str, ...], dict[str, str]]] = {
    "argument": (("--token", TOKEN), {}),
    "joined argument": ((f"--token={TOKEN}",), {}),
    "file": (("--token-file", "FILE"), {"KINESIC_TOKEN": "of the environment"}),
    "environment": ((), {"KINESIC_TOKEN": TOKEN}),
}


@needs_proc
@pytest.mark.parametrize(
    "source",
    ["argument", *(pytest.param(name, marks=pytest.mark.soak) for name in TOKEN_SOURCES if name != "argument")],
)
def test_server_requires_and_hides_its_token_and_ends_cleanly_on_ctrl_c(source: str, token_file: Path):
    options, environment = TOKEN_SOURCES[source]
    options = tuple(str(token_file) if option == "FILE" else option for option in options)
    serve = ("serve", "--voice", "durations", "--listen", "127.0.0.1:0", *options)
    with running(*serve, until=r"listening at 127.0.0.1:(\d+)", **environment) as (process, match, output):
        lines = command_lines(process.pid)
        port = int(match[1])
        with pytest.raises(PermissionError):
            Client(port=port, token="wrong")
        with Client(port=port, token=TOKEN) as client:
            client.send(NOD)
            while 'id="cut:start"' not in client.receive(MAX_WAIT):
                pass
            process.send_signal(signal.SIGINT)
            rest = receive_until_closed(client)
        assert process.wait(MAX_WAIT) == 0
    assert len(lines) > 1
    assert not [line for line in lines if TOKEN.encode() in line]
    assert TOKEN not in output
    assert ("--token-file FILE, or set KINESIC_TOKEN" in output) == ("argument" in source)
    assert "cut:end" in rest
    assert "the server ends" in rest


def receive_until_closed(client: Client) -> str:
    """Return all messages until the server ends the connection."""
    messages: list[str] = []
    with suppress(ConnectionError):
        while (message := client.receive(MAX_WAIT)) is not None:
            messages.append(message)
    return "\n".join(messages)


@needs_proc
@pytest.mark.skipif(find_spec("mcp") is None, reason="the extra mcp is not installed")
@pytest.mark.soak  # tests/mcp/test_stop.py passes a token to the tools on standard streams
@pytest.mark.parametrize("source", ["argument", "environment"])
def test_mcp_server_hides_the_token_and_ends_its_robot_server_with_itself(source: str):
    options, environment = TOKEN_SOURCES[source]
    with running("mcp", "--http", "127.0.0.1:0", *options, until=r"tools at", **environment) as (process, _, output):
        lines = command_lines(process.pid)
        server = find_server(process.pid)
    wait_for(lambda: not is_running(server))
    assert sum(b"\0serve\0" in line for line in lines) == 1
    assert not [line for line in lines if TOKEN.encode() in line]
    assert TOKEN not in output


def test_server_refuses_a_world_readable_token_file_or_two_tokens(kinesic, token_file: Path):
    both = kinesic("serve", "--token", TOKEN, "--token-file", str(token_file))
    assert (both.code, TOKEN in both.err) == (2, False)
    assert "--token and --token-file: give one of them" in both.err
    token_file.chmod(0o644)
    readable = kinesic("serve", "--token-file", str(token_file))
    assert readable.code == 2
    assert "other users can read it" in readable.err


@pytest.mark.parametrize(
    ("arguments", "hidden"),
    [
        (b"kinesic\0serve\0--token\0serve\0", b"kinesic\0serve\0--token\0xxxxx\0"),
        (b"kinesic\0serve\0--token=a=b\0--text\0", b"kinesic\0serve\0--token=xxx\0--text\0"),
        (b"kinesic\0serve\0--token-file\0a\0", b"kinesic\0serve\0--token-file\0a\0"),
        (b"kinesic\0--token\0", b"kinesic\0--token\0"),
    ],
)
def test_only_the_token_is_overwritten_in_process_arguments(arguments: bytes, hidden: bytes):
    assert _without_token(arguments) == hidden
