"""Local studio page for a robot that another server drives (`studio --connect`)."""

import asyncio
import json
import signal
from collections.abc import Callable, Mapping
from dataclasses import replace
from ipaddress import ip_address

import click

from kinesic.body.config import ConfigError
from kinesic.cli.ending_signals import detach_closed_terminal
from kinesic.cli.options import Planning
from kinesic.client import DEFAULT_PORT, Client
from kinesic.host import ENDING_SIGNALS
from kinesic.planning.setup import Setup
from kinesic.serve.address import Address
from kinesic.serve.wire.pages import WebFile
from kinesic.studio.relay import open_relay

ANSWER_TIMEOUT = 5.0  # [s] longest wait for the server's answer


def read_server(text: str) -> Address:
    """Parse the address HOST[:PORT] of a running server.

    Raises:
        ConfigError: the text is not an address.
    """
    try:
        host, port = str(ip_address(text.strip("[]"))), str(DEFAULT_PORT)  # IPv6 addresses contain colons.
    except ValueError:
        host, port = text.rpartition(":")[::2] if ":" in text else (text, str(DEFAULT_PORT))
    host = host.strip("[]")
    if not host or not port.isdecimal() or not 0 < int(port) <= 65_535:
        raise ConfigError(f"--connect {text}: give HOST or HOST:PORT, such as robot.local:{DEFAULT_PORT}")
    return Address(host, int(port))


def ask_robot(server: Address, token: str | None) -> str:
    """Query the name of the robot that a server drives.

    Raises:
        ConfigError: no server answers, the token is wrong or missing, or it is not a kinesic server.
    """
    try:
        with Client(server.host, server.port, token=token, timeout=ANSWER_TIMEOUT) as robot:
            robot.do("status")
            while (message := robot.receive(ANSWER_TIMEOUT)) is not None:
                reply = json.loads(message) if message.startswith("{") else {}
                if reply.get("told") == "refused":
                    raise ConfigError(f"--connect {server}: {reply.get('why')}; give --token-file")
                if "robot" in reply:
                    return str(reply["robot"])
    except PermissionError as error:
        raise ConfigError(f"--connect {server}: {error}; give --token-file, or set KINESIC_TOKEN") from None
    except OSError as error:
        reason = error.strerror or error
        raise ConfigError(f"--connect {server}: {reason}; is `kinesic serve` running there, at that port?") from None
    raise ConfigError(f"--connect {server}: the server does not report its robot; is it `kinesic serve`?")


def set_up_like(planning: Planning, robot: str, server: Address) -> Setup:
    """Set up planning for the robot that a server drives.

    The robot is the one named on the command line, or one that comes with kinesic.

    Raises:
        ConfigError: the server drives another robot.
    """
    setup = planning.set_up()
    if setup.robot.name == robot:
        return setup
    try:
        return replace(planning, robot=robot).set_up()
    except ConfigError:
        raise ConfigError(f"{server} drives {robot}, which is unknown here; give its file with --robot") from None


def show_page(
    page_address: Address, robot_address: Address, files: Mapping[str, WebFile], announce: Callable[[Address], None]
) -> int:
    """Serve the studio page until Ctrl-C, which does not stop the robot."""
    return asyncio.run(_serve_page(page_address, robot_address, files, announce))


async def _serve_page(
    page_address: Address, robot_address: Address, files: Mapping[str, WebFile], announce: Callable[[Address], None]
) -> int:
    end_requested = asyncio.Event()

    def end() -> None:
        detach_closed_terminal()
        end_requested.set()

    for number in (number for number in ENDING_SIGNALS if signal.getsignal(number) is not signal.SIG_IGN):
        asyncio.get_running_loop().add_signal_handler(number, end)
    async with open_relay(page_address, robot_address, files) as address:
        click.echo(f"attached to {robot_address}; Ctrl-C ends the page, not the server of the robot", err=True)
        announce(address)
        await end_requested.wait()
    return 0
