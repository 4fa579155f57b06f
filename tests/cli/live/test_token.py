"""The token of a server is in no process list, wherever it comes from."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest

from kinesic.cli.live.token import _without_token
from kinesic.client import Client

pytestmark = pytest.mark.realtime

TOKEN = "open-sesame-1234"
KINESIC = (sys.executable, "-m", "kinesic")
needs_proc = pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="no /proc: arguments cannot be seen here")


def command_lines(pid: int) -> list[bytes]:
    """Return the command lines of a process and of all its descendants."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [
        Path(f"/proc/{pid}/cmdline").read_bytes(),
        *(each for child in children for each in command_lines(int(child))),
    ]


@contextmanager
def running(
    *arguments: str, until: str, **environment: str
) -> Iterator[tuple[subprocess.Popen[str], re.Match[str], str]]:
    """A verb, what it said when it was ready, and all that it said before."""
    usual = {name: value for name, value in os.environ.items() if name != "KINESIC_TOKEN"}
    with subprocess.Popen(
        [*KINESIC, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=usual | environment,
    ) as process:
        try:
            said = ""
            for line in process.stderr:
                said += line
                if found := re.search(until, line):
                    break
            else:
                raise AssertionError(said)
            yield process, found, said
        finally:
            process.kill()


@pytest.fixture
def token_file(tmp_path: Path) -> Path:
    path = tmp_path / "token"
    path.touch(0o600)
    path.write_text(f"{TOKEN}\n")
    return path


GIVEN: Mapping[str, tuple[tuple[str, ...], dict[str, str]]] = {
    "argument": (("--token", TOKEN), {}),
    "joined argument": ((f"--token={TOKEN}",), {}),
    "file": (("--token-file", "FILE"), {"KINESIC_TOKEN": "of the environment"}),
    "environment": ((), {"KINESIC_TOKEN": TOKEN}),
}


@needs_proc
@pytest.mark.parametrize("way", GIVEN)
def test_a_server_asks_for_its_token_and_no_process_shows_it(way: str, token_file: Path):
    options, environment = GIVEN[way]
    options = tuple(str(token_file) if each == "FILE" else each for each in options)
    serve = ("serve", "--voice", "durations", "--listen", "127.0.0.1:0", *options)
    with running(*serve, until=r"listening at 127.0.0.1:(\d+)", **environment) as (process, found, said):
        lines = command_lines(process.pid)
        port = int(found[1])
        with pytest.raises(PermissionError):
            Client(port=port, token="wrong")
        Client(port=port, token=TOKEN).close()
    assert len(lines) > 1
    assert not [line for line in lines if TOKEN.encode() in line]
    assert TOKEN not in said
    assert ("--token-file FILE, or set KINESIC_TOKEN" in said) == ("argument" in way)


@needs_proc
@pytest.mark.skipif(find_spec("mcp") is None, reason="the extra mcp is not installed")
@pytest.mark.parametrize("way", ["argument", "environment"])
def test_tools_and_the_server_that_they_begin_show_no_token(way: str):
    options, environment = GIVEN[way]
    with running("mcp", "--http", "127.0.0.1:0", *options, until=r"tools at", **environment) as (process, _, said):
        lines = command_lines(process.pid)
    assert sum(b"\0serve\0" in line for line in lines) == 1
    assert not [line for line in lines if TOKEN.encode() in line]
    assert TOKEN not in said


def test_a_file_that_others_can_read_and_two_tokens_are_refused(kinesic, token_file: Path):
    twice = kinesic("serve", "--token", TOKEN, "--token-file", str(token_file))
    assert (twice.code, TOKEN in twice.err) == (2, False)
    assert "--token and --token-file: give one of them" in twice.err
    token_file.chmod(0o644)
    shared = kinesic("serve", "--token-file", str(token_file))
    assert shared.code == 2
    assert "other users can read it" in shared.err


@pytest.mark.parametrize(
    ("arguments", "hidden"),
    [
        (b"kinesic\0serve\0--token\0serve\0", b"kinesic\0serve\0--token\0xxxxx\0"),
        (b"kinesic\0serve\0--token=a=b\0--text\0", b"kinesic\0serve\0--token=xxx\0--text\0"),
        (b"kinesic\0serve\0--token-file\0a\0", b"kinesic\0serve\0--token-file\0a\0"),
        (b"kinesic\0--token\0", b"kinesic\0--token\0"),
    ],
)
def test_only_the_token_is_overwritten(arguments: bytes, hidden: bytes):
    assert _without_token(arguments) == hidden
