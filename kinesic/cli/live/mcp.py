"""`kinesic mcp`: tools for a language model, before a server that performs."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from threading import Thread

import click

from kinesic.body.config import ConfigError
from kinesic.cli.live.serve import read_address
from kinesic.cli.options import Performers, Planning
from kinesic.controller.options import offers
from kinesic.serve.priority import urgent
from kinesic.serve.server import Address

ENDING = 15.0  # [s] in which a server of our own folds the arms and ends
SWITCH_INTERVAL = 0.0001  # [s] after which a thread that writes a document yields to one that stops
LISTENS = re.compile(r"listening at (\S+):(\d+)")


def serve_tools(
    planning: Planning, performers: Performers, connect: str | None, token: str | None, http: str | None
) -> int:
    """Serves the tools until the client is gone."""
    try:
        from kinesic.mcp.robot_line import RobotLine  # noqa: PLC0415 - the extra may be missing
        from kinesic.mcp.server import make_server  # noqa: PLC0415 - as above
        from kinesic.mcp.web import serve_web  # noqa: PLC0415 - as above
    except ModuleNotFoundError as error:
        raise ConfigError(f"kinesic mcp needs {error.name}: pip install 'kinesic[mcp]'") from None
    address = None if http is None else read_address(http, token)
    known = planning.set_up()
    sys.setswitchinterval(SWITCH_INTERVAL)
    # All threads are urgent: whichever holds the interpreter would hold up a stop while other work of the machine runs.
    with _server(connect, planning, performers, token) as place, urgent():
        try:
            robot = RobotLine(place.host, place.port, token=token)
        except OSError as error:
            raise ConfigError(f"--connect {place}: {error}; start kinesic serve there") from None
        with closing(robot):
            server = make_server(robot, known, resumes="servos" not in performers.sinks and connect is None)
            if address is None:
                server.run("stdio")
            else:
                click.echo(f"tools at http://{address}/mcp", err=True)
                serve_web(server, address.host, address.port, token=token)
    return 0


@contextmanager
def _server(connect: str | None, planning: Planning, performers: Performers, token: str | None) -> Iterator[Address]:
    """Yield the address of a running or newly started server."""
    if connect is not None:
        host, _, port = connect.rpartition(":")
        if not host or not port.isdecimal():
            raise ConfigError(f"--connect {connect}: give HOST:PORT, such as 127.0.0.1:8864")
        yield Address(host.strip("[]"), int(port))
        return
    own = [sys.executable, "-m", "kinesic", "serve", "--listen", "127.0.0.1:0", "--end-with-input"]
    own += _arguments(planning, performers)
    # Its standard input closes with this process, whatever becomes of it: then the server folds the arms and ends.
    environment = {**os.environ, "KINESIC_TOKEN": token or ""}  # arguments are for everybody to see
    with subprocess.Popen(
        own, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment
    ) as it:
        assert it.stdin is not None  # both are pipes
        assert it.stderr is not None
        try:
            said = []
            for line in it.stderr:
                said.append(line.strip())
                if found := LISTENS.search(line):
                    Thread(target=it.stderr.read, daemon=True).start()  # nobody listens to what it says from now on
                    yield Address(found[1], int(found[2]))
                    return
            raise ConfigError(f"the server does not begin: {' '.join(said[-3:]) or 'it says nothing'}")
        finally:
            it.stdin.close()
            with suppress(subprocess.TimeoutExpired):
                it.wait(ENDING)
            it.kill()


def _arguments(planning: Planning, performers: Performers) -> list[str]:
    """Writes options as the command line of another process has them."""
    options = [f"--robot={planning.robot}", f"--style={planning.style}", f"--on={','.join(sorted(performers.sinks))}"]
    options += [f"--port={port}" for port in performers.ports]
    for name, offer in offers().items():
        value = planning.options.get(name)
        values = value if offer.many and isinstance(value, tuple) else (value,)
        options += [f"{offer.flag or f'--{name}'}={each}" for each in values if each is not None]
    return options
