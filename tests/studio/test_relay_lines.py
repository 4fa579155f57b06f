"""Connections of the relay between a page and an echo server."""

import asyncio
import socket
from collections.abc import Awaitable, Callable
from http import HTTPStatus

import pytest
from websockets.asyncio.client import connect
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed, InvalidStatus

from kinesic.body.config import ConfigError
from kinesic.serve.server import Address
from kinesic.serve.wire.pages import WebFile
from kinesic.studio import relay
from kinesic.studio.relay import TRY_LATER_CODE, open_relay

FILES = {"/": WebFile("text/html", b"<p>the page</p>")}
PATIENCE = 30.0  # [s] timeout of a connection
LONG = 2_000_000  # [bytes] size of a long message


class Robot:
    """Echo server that closes a connection after the message `go`."""

    def __init__(self) -> None:
        self.lines: list[ServerConnection] = []
        self.ended = 0

    async def talk(self, line: ServerConnection) -> None:
        self.lines.append(line)
        try:
            async for message in line:
                if message == "go":
                    return
                await line.send(message)
        finally:
            self.ended += 1


def relayed(deed: Callable[[Address, Robot], Awaitable[None]]) -> None:
    async def act() -> None:
        robot = Robot()
        async with serve(robot.talk, "127.0.0.1", 0, max_size=LONG) as server:
            port = next(iter(server.sockets)).getsockname()[1]
            async with open_relay(Address("127.0.0.1", 0), Address("127.0.0.1", port), FILES) as door:
                await asyncio.wait_for(deed(door, robot), PATIENCE)

    asyncio.run(act())


def test_studio_relay_passes_text_and_binary_messages_unchanged():
    async def act(door: Address, _robot: Robot) -> None:
        async with connect(f"ws://{door}/", max_size=LONG) as page:
            for message in ("text \N{GRINNING FACE}", b"\0bytes", "x" * (LONG - 1)):
                await page.send(message)
                assert await page.recv() == message

    relayed(act)


def test_studio_relay_gives_each_page_its_own_robot_connection():
    async def act(door: Address, robot: Robot) -> None:
        async with connect(f"ws://{door}/") as one, connect(f"ws://{door}/") as other:
            for page in (one, other):
                await page.send("hello")
                await page.recv()
            assert len(robot.lines) == 2
            await one.close()
            while robot.ended < 1:
                await asyncio.sleep(0.01)
            await other.send("still here")
            assert await other.recv() == "still here"

    relayed(act)


def test_studio_relay_closes_the_page_connection_when_the_robot_disconnects():
    async def act(door: Address, _robot: Robot) -> None:
        async with connect(f"ws://{door}/") as page:
            await page.send("go")
            with pytest.raises(ConnectionClosed):
                await page.recv()

    relayed(act)


def test_studio_relay_connects_to_the_robot_without_origin_and_extension_headers():
    async def act(door: Address, robot: Robot) -> None:
        async with connect(f"ws://{door}/", origin=f"http://{door}") as page:
            await page.send("hello")
            await page.recv()
            assert "Origin" not in robot.lines[0].request.headers
            assert "Sec-WebSocket-Extensions" not in robot.lines[0].request.headers

    relayed(act)


@pytest.mark.parametrize("origin", ["http://elsewhere.example", "null"])
def test_studio_relay_rejects_foreign_origins_without_contacting_the_robot(origin: str):
    async def act(door: Address, robot: Robot) -> None:
        with pytest.raises(InvalidStatus) as caught:
            await connect(f"ws://{door}/", origin=origin)
        assert caught.value.response.status_code == HTTPStatus.FORBIDDEN
        assert robot.lines == []

    relayed(act)


def test_studio_relay_serves_only_files_of_the_page():
    async def ask(door: Address, path: str) -> bytes:
        reader, writer = await asyncio.open_connection(door.host, door.port)
        writer.write(f"GET {path} HTTP/1.1\r\nHost: {door}\r\n\r\n".encode())
        answer = await reader.read(4096)
        writer.close()
        return answer

    async def act(door: Address, robot: Robot) -> None:
        result = await ask(door, "/")
        assert result.startswith(b"HTTP/1.1 200")
        assert result.endswith(b"<p>the page</p>")
        assert (await ask(door, "/secret")).startswith(b"HTTP/1.1 404")
        assert robot.lines == []

    relayed(act)


def test_studio_relay_asks_the_page_to_retry_if_the_robot_is_unreachable():
    async def act() -> None:
        with socket.socket() as nobody:
            nobody.bind(("127.0.0.1", 0))
            gone = Address("127.0.0.1", nobody.getsockname()[1])
            async with open_relay(Address("127.0.0.1", 0), gone, FILES) as door, connect(f"ws://{door}/") as page:
                with pytest.raises(ConnectionClosed) as caught:
                    await asyncio.wait_for(page.recv(), PATIENCE)
                assert caught.value.rcvd.code == TRY_LATER_CODE
                assert caught.value.rcvd.reason.startswith(f"{gone} is not reachable: ")
                assert len(caught.value.rcvd.reason) <= 100

    asyncio.run(act())


def test_occupied_address_of_a_studio_relay_is_an_error_with_a_hint():
    async def act(door: Address, _robot: Robot) -> None:
        assert door.host == "127.0.0.1"
        with pytest.raises(ConfigError, match=rf"{door}: .*; select another address with --listen"):
            async with open_relay(door, door, FILES):
                pass

    relayed(act)


def test_message_above_the_size_limit_of_the_studio_relay_closes_the_connection(monkeypatch):
    monkeypatch.setattr(relay, "MAX_MESSAGE_SIZE", 1000)

    async def act(door: Address, _robot: Robot) -> None:
        async with connect(f"ws://{door}/") as page:
            await page.send("x" * 1000)
            assert await page.recv() == "x" * 1000
            await page.send("x" * 1001)
            with pytest.raises(ConnectionClosed):
                await page.recv()

    relayed(act)
