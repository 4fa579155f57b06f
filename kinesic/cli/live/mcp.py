"""Verb `kinesic mcp`: tools that let a language model use a server.

Clients give a program a few seconds to answer. So the server of the robot starts in its own process while this one
imports, and the tools wait for it.
"""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future, InvalidStateError, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import click

from kinesic.body.config import ConfigError
from kinesic.cli.live.addresses import read_listen_address
from kinesic.cli.options import Performers, Planning
from kinesic.expressivity.lexicon.categories import GESTURE_CATEGORIES
from kinesic.extras import install_extra
from kinesic.heap import freeze_heap
from kinesic.importing import import_at_once
from kinesic.mcp.errors import RobotError
from kinesic.serve.address import Address
from kinesic.serve.priority import raise_priority
from kinesic.session.options import list_cli_options

if TYPE_CHECKING:
    from kinesic.expressivity.lexicon.lexicon import Lexicon
    from kinesic.mcp.robot_line import RobotLine
    from kinesic.planning.setup import Setup

SERVER_END_TIMEOUT = 15.0  # [s] longest time for the robot's server to fold the arms and end
SWITCH_INTERVAL = 0.0001  # [s] Python thread switch interval; short, so that an emergency stop is prompt
LISTENING_PATTERN = re.compile(r"listening at (\S+):(\d+)")  # line of the server with its address
START_EXIT_CODE = 2  # exit code if the server of the robot does not start


def serve_tools(
    planning: Planning, performers: Performers, connect: str | None, token: str | None, http: str | None
) -> int:
    """Serve the MCP tools until the client disconnects."""
    address = None if http is None else read_listen_address(http, token)
    # All threads get priority, because any thread that holds the interpreter could delay an emergency stop.
    with _open_robot(connect, planning, performers, token) as opened, raise_priority():
        try:
            import_at_once("kinesic.mcp.server")
        except ModuleNotFoundError as error:
            raise ConfigError(f"kinesic mcp needs {error.name}: {install_extra('mcp')}") from None
        from kinesic.mcp.robot_gate import RobotGate  # noqa: PLC0415 - optional dependency
        from kinesic.mcp.server import make_server  # noqa: PLC0415 - as above

        @cache
        def load_lexicon() -> "Lexicon":
            return _load_lexicon(planning)

        has_own_gestures = planning.options.get("lexicon") is not None
        categories = load_lexicon().categories if has_own_gestures else GESTURE_CATEGORIES
        setup = ThreadPoolExecutor(1, thread_name_prefix="setup").submit(load_setup, planning, opened)
        sys.setswitchinterval(SWITCH_INTERVAL)
        resumes = "servos" not in performers.sinks and connect is None
        server = make_server(RobotGate(opened, setup), load_lexicon, resumes=resumes, categories=categories)
        if address is None:
            setup.add_done_callback(_report_invalid)
            server.run("stdio")
        else:
            setup.result()
            from kinesic.mcp.web import serve_web  # noqa: PLC0415 - as above

            click.echo(f"tools at http://{address}/mcp", err=True)
            serve_web(server, address.host, address.port, token=token)
        return START_EXIT_CODE if opened.done() and opened.exception() is not None else 0


def _load_lexicon(planning: Planning) -> "Lexicon":
    from kinesic.expressivity.lexicon.lexicon import Lexicon  # noqa: PLC0415 - slow to import

    path = planning.options.get("lexicon")
    return Lexicon.load(None if path is None else Path(path))


def load_setup(planning: Planning, opened: "Future[RobotLine]") -> "Setup":
    """Load the planning setup once the server listens.

    The first answers then need not wait.

    Raises:
        ConfigError: the server does not start, or an option is invalid.
    """
    from kinesic.mcp.server import warm_up_tools  # noqa: PLC0415 - slow to import

    if (error := opened.exception()) is not None:
        raise ConfigError(str(error))
    setup = warm_up_tools(planning.set_up())
    freeze_heap()
    return setup


def _report_invalid(setup: "Future[Setup]") -> None:
    """Print the configuration error of a setup that failed to load."""
    if isinstance(error := setup.exception(), ConfigError):
        click.echo(f"kinesic: {error}", err=True)


@contextmanager
def _open_robot(
    connect: str | None, planning: Planning, performers: Performers, token: str | None
) -> "Iterator[Future[RobotLine]]":
    """Yield a future of the connection to a running or new server.

    The server that was started, and the connections, end with the context.
    """
    if connect is not None:
        line = _connect(_read_server(connect), token, connect)
        opened: Future[RobotLine] = Future()
        opened.set_result(line)
        try:
            yield opened
        finally:
            line.close()
        return
    with _start_server(planning, performers, token) as opened:
        yield opened


def _read_server(connect: str) -> Address:
    """Parse the address HOST:PORT of a running server.

    Raises:
        ConfigError: the text is not an address.
    """
    host, _, port = connect.rpartition(":")
    if not host or not port.isdecimal():
        raise ConfigError(f"--connect {connect}: give HOST:PORT, such as 127.0.0.1:8864")
    return Address(host.strip("[]"), int(port))


def _connect(address: Address, token: str | None, connect: str) -> "RobotLine":
    from kinesic.mcp.robot_line import RobotLine  # noqa: PLC0415 - slow to import

    try:
        return RobotLine(address.host, address.port, token=token)
    except OSError as error:
        raise ConfigError(f"--connect {connect}: {error}; start kinesic serve there") from None


@contextmanager
def _start_server(planning: Planning, performers: Performers, token: str | None) -> "Iterator[Future[RobotLine]]":
    """Start a server, and yield a future of the server's connection."""
    command = [sys.executable, "-m", "kinesic", "serve", "--listen", "127.0.0.1:0", "--end-with-input"]
    command += _list_arguments(planning, performers)
    # Standard input of the server closes when this process ends in any way; the server then folds the arms and ends.
    environment = {**os.environ, "KINESIC_TOKEN": token or ""}  # Arguments are visible to other users.
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment
    ) as server:
        assert server.stdin is not None  # Both streams are pipes.
        opened: Future[RobotLine] = Future()
        reader = Thread(target=_follow, args=(server, opened, token), daemon=True, name="server")
        with raise_priority():  # otherwise its imports would hold back those of this thread
            reader.start()
        try:
            yield opened
        finally:
            server.stdin.close()
            if not opened.cancel() and opened.exception() is None:
                opened.result().close()
            with suppress(subprocess.TimeoutExpired):
                server.wait(SERVER_END_TIMEOUT)
            server.kill()


def _follow(server: "subprocess.Popen[str]", opened: "Future[RobotLine]", token: str | None) -> None:
    """Connect once the started server listens, and discard its later output."""
    assert server.stderr is not None  # It is a pipe.
    lines = []
    for line in server.stderr:
        lines.append(line.strip())
        if not opened.done() and (match := LISTENING_PATTERN.search(line)):
            from kinesic.mcp.robot_line import RobotLine  # noqa: PLC0415 - slow to import

            try:
                robot = RobotLine(match[1], int(match[2]), token=token)
            except OSError as error:
                _fail(opened, str(error))
                continue
            try:
                opened.set_result(robot)
            except InvalidStateError:  # the client has disconnected
                robot.close()
    if not opened.done():
        _fail(opened, " ".join(lines[-3:]) or "it printed nothing")


def _fail(opened: "Future[RobotLine]", why: str) -> None:
    if opened.cancelled():
        return
    text = f"the server of the robot does not start: {why}"
    opened.set_exception(RobotError(f"{text}. Nothing can move until kinesic mcp is started again"))


def _list_arguments(planning: Planning, performers: Performers) -> list[str]:
    """Convert planning options, outputs and ports to arguments of the server."""
    options = [f"--robot={planning.robot}", f"--style={planning.style}", f"--on={','.join(sorted(performers.sinks))}"]
    options += [f"--port={port}" for port in performers.ports]
    for name, option in list_cli_options().items():
        value = planning.options.get(name)
        values = value if option.many and isinstance(value, tuple) else (value,)
        options += [f"{option.flag or f'--{name}'}={item}" for item in values if item is not None]
    return options
