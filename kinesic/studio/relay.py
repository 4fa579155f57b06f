"""Shows the page on this machine for a robot behind another server: what either says is passed on as it is.

The page talks to this process alone, which connects to the robot as a program does, once for each connection of the
page: so the emergency stop has its own line all the way. Nothing of what is said is read or kept here.
"""

from asyncio import FIRST_COMPLETED, create_task, wait
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress

from websockets.asyncio.client import ClientConnection, connect
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.http11 import Request, Response

from kinesic.body.config import ConfigError
from kinesic.serve.server import Address
from kinesic.serve.wire.origin import find_rejection, own_authorities
from kinesic.serve.wire.pages import WebFile, asks_for_file, show_file

LARGEST_MESSAGE = 16_000_000  # [bytes] of a message, either way; the server has its own rules
CONNECTION_TIMEOUT = 5.0  # [s] for the robot to take a connection
LATER = 1013  # WebSocket's code for a robot that is not there now


@asynccontextmanager
async def open_relay(door: Address, robot: Address, files: Mapping[str, WebFile]) -> AsyncIterator[Address]:
    """Shows files at an address, and passes WebSockets on; says where.

    Args:
        door: of this machine; port 0: any that is free.
        robot: the server that drives it.
        files: of the page, by their path.

    Raises:
        ConfigError: the address cannot be had.
    """

    def answer(connection: ServerConnection, request: Request) -> Response | None:
        here, port = connection.local_address[:2]
        rejection = find_rejection(request.headers, own_authorities(door.host, here, port), frozenset())
        if rejection is not None:
            return connection.respond(rejection.status, f"{rejection.why}\n")
        return show_file(request.path, files) if asks_for_file(request) else None

    async def pass_on(page: ServerConnection) -> None:
        await _pass_on(page, robot)

    try:
        server = await serve(
            pass_on, door.host, door.port, process_request=answer, max_size=LARGEST_MESSAGE, compression=None
        )
    except OSError as error:
        raise ConfigError(f"{door}: {error.strerror}; give another one with --listen") from None
    async with server:
        yield Address(door.host, next(iter(server.sockets)).getsockname()[1])


async def _pass_on(page: ServerConnection, robot: Address) -> None:
    """Passes messages on between a page and the robot, until either ends."""
    try:
        line = await connect(
            f"ws://{robot}/",
            max_size=LARGEST_MESSAGE,
            compression=None,
            open_timeout=CONNECTION_TIMEOUT,
            origin=None,
            proxy=None,
        )
    except (OSError, InvalidHandshake) as error:
        await page.close(LATER, f"{robot} is not there: {error}"[:100])
        return
    async with line:
        ways = {create_task(_carry(page, line)), create_task(_carry(line, page))}
        _, left = await wait(ways, return_when=FIRST_COMPLETED)
        for way in left:
            way.cancel()
        await page.close()


async def _carry(begin: ServerConnection | ClientConnection, end: ServerConnection | ClientConnection) -> None:
    with suppress(ConnectionClosed):
        async for message in begin:
            await end.send(message)
