"""Local web server of the studio page for a remote robot.

Messages are passed on unchanged.

The page talks only to this process, which opens one connection to the robot for each connection of the page, so that
the emergency stop has its own line all the way. Messages are neither read nor stored.
"""

from asyncio import FIRST_COMPLETED, create_task, wait
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress

from websockets.asyncio.client import ClientConnection, connect
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.http11 import Request, Response

from kinesic.body.config import ConfigError
from kinesic.serve.address import Address
from kinesic.serve.wire.origin import find_rejection, own_authorities
from kinesic.serve.wire.pages import WebFile, asks_for_file, file_response

MAX_MESSAGE_SIZE = 16_000_000  # [bytes] largest relayed message; the robot's server has its own limits
CONNECTION_TIMEOUT = 5.0  # [s] time limit to connect to the robot's server
TRY_LATER_CODE = 1013  # WebSocket close code for an unreachable robot


@asynccontextmanager
async def open_relay(local: Address, robot: Address, files: Mapping[str, WebFile]) -> AsyncIterator[Address]:
    """Serve the studio page and relay its WebSockets to the robot's server.

    Yields the address of the page.

    Args:
        local: address on this machine; port 0 selects a free port.
        robot: address of the robot's server.
        files: files of the page by path.

    Raises:
        ConfigError: the address is not available.
    """

    def answer(connection: ServerConnection, request: Request) -> Response | None:
        here, port = connection.local_address[:2]
        rejection = find_rejection(request.headers, own_authorities(local.host, here, port), frozenset())
        if rejection is not None:
            return connection.respond(rejection.status, f"{rejection.why}\n")
        return file_response(request.path, files) if asks_for_file(request) else None

    async def pass_on(page: ServerConnection) -> None:
        await _pass_on(page, robot)

    try:
        server = await serve(
            pass_on, local.host, local.port, process_request=answer, max_size=MAX_MESSAGE_SIZE, compression=None
        )
    except OSError as error:
        raise ConfigError(f"{local}: {error.strerror}; select another address with --listen") from None
    async with server:
        yield Address(local.host, next(iter(server.sockets)).getsockname()[1])


async def _pass_on(page: ServerConnection, robot: Address) -> None:
    """Relay messages between a page and the robot until either closes."""
    try:
        line = await connect(
            f"ws://{robot}/",
            max_size=MAX_MESSAGE_SIZE,
            compression=None,
            open_timeout=CONNECTION_TIMEOUT,
            origin=None,
            proxy=None,
        )
    except (OSError, InvalidHandshake) as error:
        await page.close(TRY_LATER_CODE, f"{robot} is not reachable: {error}"[:100])
        return
    async with line:
        transfers = {create_task(_carry(page, line)), create_task(_carry(line, page))}
        _, unfinished = await wait(transfers, return_when=FIRST_COMPLETED)
        for transfer in unfinished:
            transfer.cancel()
        await page.close()


async def _carry(begin: ServerConnection | ClientConnection, end: ServerConnection | ClientConnection) -> None:
    with suppress(ConnectionClosed):
        async for message in begin:
            await end.send(message)
