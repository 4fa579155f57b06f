"""Admission of connections on a real port, with a stub session."""

import asyncio
import json
import socket

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve.reception import Reception, serve_console
from kinesic.serve.wire.pages import WebFile
from kinesic.serve.wire.quotas import Quotas
from kinesic.serve.wire.transport import UNADMITTED_READ_LIMIT

from .played_door import PING, PONG, RULES, SHORT_QUOTAS, PlayedStopLines, opened
from .played_registry import TOKEN_ACCESS, Registry

UPGRADE = (
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n%s\r\n"
)


@pytest.mark.parametrize("message", [PING, b" \r\n\t" + PING, b"\xef\xbb\xbf" + PING])
def test_client_is_admitted_by_its_first_message(message: bytes) -> None:
    async def run() -> None:
        async with opened() as door:
            assert await door.ask(message) == PONG

    asyncio.run(run())


def test_document_sent_as_first_message_has_the_client_address_as_source() -> None:
    async def run() -> None:
        async with opened() as door:
            _, writer = await door.connect(b"<bml/>\0" + PING)
            while not door.registry.session.performed:
                await asyncio.sleep(0.005)
            name = ":".join(map(str, writer.get_extra_info("sockname")))
            assert door.registry.session.performed[0].source == f"<{name}, message 1>"

    asyncio.run(run())


@pytest.mark.parametrize("first", [b"POST / HTTP/1.1\r\n", b"hello\0", b"\0\0\0\0", bytes(UNADMITTED_READ_LIMIT)])
def test_connections_of_unknown_protocols_are_closed_without_an_answer(first: bytes) -> None:
    async def run() -> None:
        async with opened() as door:
            reader, writer = await door.connect(first)
            writer.write_eof()
            assert await reader.read() == b""
            assert not door.registry._clients

    asyncio.run(run())


def test_connection_sending_only_blanks_is_closed_at_a_limit() -> None:
    async def run() -> None:
        async with opened() as door:
            reader, _ = await door.connect(b" " * (3 * UNADMITTED_READ_LIMIT))
            assert await reader.read() == b""

    asyncio.run(run())


def test_first_message_of_each_protocol_may_arrive_in_pieces() -> None:
    async def run() -> None:
        async with opened() as door:
            reader, writer = await door.connect(b" ")
            for piece in (b"\n", b'{"do": "pi', b'ng", "id": "x"}\0'):
                await asyncio.sleep(0.02)
                writer.write(piece)
            assert json.loads((await reader.readuntil(b"\0")).strip(b"\n\0")) == PONG
            writer.close()
            reader, writer = await door.connect(b"G")
            await asyncio.sleep(0.02)
            writer.write((UPGRADE % (door.port, b""))[1:])
            assert (await reader.readline()).split()[1] == b"101"

    asyncio.run(run())


@pytest.mark.parametrize(
    ("header", "status"),
    [(b"", b"101"), (b"Authorization: Bearer wrong\r\n", b"401"), (b"Origin: http://x\r\n", b"403")],
)
def test_websocket_handshake_status_depends_on_token_and_origin(header: bytes, status: bytes) -> None:
    async def run() -> None:
        async with opened(TOKEN_ACCESS) as door:
            reader, _writer = await door.connect(UPGRADE % (door.port, header))
            assert (await reader.readline()).split()[1] == status

    asyncio.run(run())


def test_only_a_websocket_with_the_token_gets_a_client_slot() -> None:
    async def run() -> tuple[list[bool], int]:
        async with opened(TOKEN_ACCESS) as door:
            for header in (b"Authorization: Bearer open sesame\r\n", b""):
                reader, _ = await door.connect(UPGRADE % (door.port, header))
                await reader.readuntil(b"\r\n\r\n")
            while len(door.registry._clients) < 2:
                await asyncio.sleep(0.005)
            return [client.placed for client in door.registry._clients.values()], len(door.reception._pending)

    assert asyncio.run(run()) == ([True, False], 1)


def test_browser_requests_get_the_files_of_the_page() -> None:
    async def run() -> bytes:
        async with opened(files={"/": WebFile("text/html", b"<p>")}) as door:
            reader, _ = await door.connect(b"GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % door.port)
            return await reader.read()

    assert asyncio.run(run()).endswith(b"\r\n\r\n<p>")


@pytest.mark.parametrize("first", [b"", b" ", b"GET /"])
def test_clients_without_a_complete_first_message_are_disconnected_after_a_timeout(first: bytes) -> None:
    async def run() -> None:
        async with opened(rules=SHORT_QUOTAS) as door:
            reader, _ = await door.connect(first)
            assert await reader.read() == b""
            assert not door.reception._pending

    asyncio.run(run())


def test_admitted_client_may_stay_silent_and_send_a_large_message() -> None:
    async def run() -> None:
        async with opened(TOKEN_ACCESS, SHORT_QUOTAS) as door:
            reader, writer = await door.connect(b'{"do": "hello", "token": "open sesame"}\0')
            await reader.readuntil(b"\0")
            assert not door.reception._pending
            await asyncio.sleep(4 * SHORT_QUOTAS.patience)
            writer.write(b"<bml>" + b" " * (3 * UNADMITTED_READ_LIMIT) + b"</bml>\0" + PING)
            assert json.loads((await reader.readuntil(b"\0")).strip(b"\n\0")) == PONG

    asyncio.run(run())


def test_stop_connection_is_moved_to_the_thread_of_stop_connections() -> None:
    async def run() -> None:
        async with opened() as door:
            reader, _writer = await door.connect(b'{"do": "stop_line"}\0')
            while not door.stop_lines.taken:
                await asyncio.sleep(0.005)
            (taken,) = door.stop_lines.taken
            taken.sendall(b"still open")
            taken.close()
            assert await reader.read() == b"still open"
            assert not door.registry._clients

    asyncio.run(run())


def test_unavailable_address_is_refused_with_the_remedy() -> None:
    async def run() -> None:
        with socket.create_server(("127.0.0.1", 0)) as taken:
            door = Reception(Registry(), PlayedStopLines())
            port = taken.getsockname()[1]
            with pytest.raises(ConfigError, match=f"--listen 127.0.0.1:{port}: .*; give another one, or port 0"):
                door.listen("127.0.0.1", port)
            assert door._listeners == []

    asyncio.run(run())


def test_closed_connection_acceptor_refuses_connections() -> None:
    async def run() -> None:
        async with opened() as door:
            door.reception.close()
            with pytest.raises(ConnectionRefusedError):
                await door.connect()

    asyncio.run(run())


def test_console_needs_no_token_and_cannot_become_a_stop_connection() -> None:
    class PlayedConsole:
        lingers = True

        def __init__(self, rules: Quotas) -> None:
            assert rules is RULES
            self.sent: list[str] = []
            consoles.append(self)

        async def messages(self, hurry):
            assert not hurry()
            yield b"<bml/>"
            yield b'{"do": "stop_line"}'

        async def send(self, message: str) -> None:
            self.sent.append(message)

        async def close(self, code: int, why: str) -> None:
            self.closed = code, why

    consoles: list[PlayedConsole] = []
    registry = Registry(TOKEN_ACCESS, RULES)
    registry.session.has_unfinished_blocks = lambda _: False
    asyncio.run(serve_console(registry, PlayedConsole))
    assert [document.source for document in registry.session.performed] == ["<stdin, message 1>"]
    assert "cannot become a stop line" in consoles[0].sent[0]
    assert registry._taken == 0
