"""`kinesic studio --connect`: the page on this machine, for a robot that another server drives."""

import asyncio
import json
import signal
from collections.abc import Callable, Mapping
from dataclasses import replace
from ipaddress import ip_address

import click

from kinesic.body.config import ConfigError
from kinesic.cli.ending_signals import leave_closed_terminal
from kinesic.cli.options import Planning
from kinesic.client import PORT, Client
from kinesic.controller.servo_performance import ENDING
from kinesic.planning.setup import Setup
from kinesic.serve.server import Address
from kinesic.serve.wire.pages import WebFile
from kinesic.studio.relay import open_relay

ANSWER_TIMEOUT = 5.0  # [s] for the server's answer


def read_server(text: str) -> Address:
    """Reads HOST[:PORT] of a server that runs.

    Raises:
        ConfigError: it is no address.
    """
    try:
        host, port = str(ip_address(text.strip("[]"))), str(PORT)  # it may have colons of its own
    except ValueError:
        host, port = text.rpartition(":")[::2] if ":" in text else (text, str(PORT))
    host = host.strip("[]")
    if not host or not port.isdecimal() or not 0 < int(port) <= 65_535:
        raise ConfigError(f"--connect {text}: give HOST or HOST:PORT, such as robot.local:{PORT}")
    return Address(host, int(port))


def ask_robot(server: Address, token: str | None) -> str:
    """Asks a server which robot it drives.

    Raises:
        ConfigError: nobody is there, the token is wrong or missing, or it is another server.
    """
    try:
        with Client(server.host, server.port, token=token, timeout=ANSWER_TIMEOUT) as robot:
            robot.do("status")
            while (message := robot.receive(ANSWER_TIMEOUT)) is not None:
                told = json.loads(message) if message.startswith("{") else {}
                if told.get("told") == "refused":
                    raise ConfigError(f"--connect {server}: {told.get('why')}; give --token-file")
                if "robot" in told:
                    return str(told["robot"])
    except PermissionError as error:
        raise ConfigError(f"--connect {server}: {error}; give --token-file, or set KINESIC_TOKEN") from None
    except OSError as error:
        why = error.strerror or error
        raise ConfigError(f"--connect {server}: {why}; is `kinesic serve` running there, at that port?") from None
    raise ConfigError(f"--connect {server}: it does not say which robot it drives; is it `kinesic serve`?")


def set_up_like(planning: Planning, robot: str, server: Address) -> Setup:
    """Sets up for the robot that a server drives: the one that is named here, or a robot of kinesic's own.

    Raises:
        ConfigError: it is none of these.
    """
    setup = planning.set_up()
    if setup.robot.name == robot:
        return setup
    try:
        return replace(planning, robot=robot).set_up()
    except ConfigError:
        raise ConfigError(f"{server} drives {robot}, which is not known here: give its file with --robot") from None


def show_page(door: Address, robot: Address, files: Mapping[str, WebFile], opened: Callable[[Address], None]) -> int:
    """Shows the page until somebody ends it; the robot goes on without it."""
    return asyncio.run(_show(door, robot, files, opened))


async def _show(door: Address, robot: Address, files: Mapping[str, WebFile], opened: Callable[[Address], None]) -> int:
    end_requested = asyncio.Event()

    def end() -> None:
        leave_closed_terminal()
        end_requested.set()

    for number in (each for each in ENDING if signal.getsignal(each) is not signal.SIG_IGN):
        asyncio.get_running_loop().add_signal_handler(number, end)
    async with open_relay(door, robot, files) as address:
        click.echo(f"attached to {robot}; Ctrl-C ends the page, and leaves the robot as it is", err=True)
        opened(address)
        await end_requested.wait()
    return 0
