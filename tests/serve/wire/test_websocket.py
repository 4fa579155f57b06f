"""WebSocket handshakes and messages, with a simulated client and no network."""

import asyncio
from collections.abc import AsyncIterator

import pytest
from websockets.client import ClientProtocol
from websockets.frames import OP_BINARY, OP_CONT, OP_TEXT, Frame
from websockets.http11 import Response
from websockets.uri import parse_uri

from kinesic.serve.wire import websocket
from kinesic.serve.wire.origin import OPEN_ACCESS, Access
from kinesic.serve.wire.pages import WebFile
from kinesic.serve.wire.quotas import Quotas
from kinesic.serve.wire.transport import HalfError
from kinesic.serve.wire.websocket import PARSE_SIZE, WebSocket

TOKEN = "open sesame"
RULES = Quotas()
AUTHORITIES = frozenset({"robot:8000"})
PAGE = {"/": WebFile("text/html", b"<p>Robot</p>")}


class ScriptedLine:
    """Transport that returns prepared bytes and records what is written."""

    def __init__(self, *chunks: bytes) -> None:
        self.chunks, self.hurries = list(chunks), list[bool]()
        self.written, self.closed = b"", False

    async def read(self, *, hurry: bool) -> bytes:
        self.hurries.append(hurry)
        return self.chunks.pop(0) if self.chunks else b""

    async def write(self, pieces) -> None:
        self.written += b"".join(pieces)

    async def close(self) -> None:
        self.closed = True

    def take(self) -> bytes:
        written, self.written = self.written, b""
        return written


class PlayedClient:
    """Client whose bytes are passed to a `WebSocket` by hand."""

    def __init__(self, *, token: str | None = None, host: str = "robot:8000", origin: str | None = None) -> None:
        self.protocol = ClientProtocol(parse_uri(f"ws://{host}/"), origin=origin)
        request = self.protocol.connect()
        if token is not None:
            request.headers["Authorization"] = f"Bearer {token}"
        self.protocol.send_request(request)
        self.request = self.sent()

    def sent(self) -> bytes:
        return b"".join(self.protocol.data_to_send())

    def text(self, text: str, *, is_last: bool = True) -> bytes:
        self.protocol.send_text(text.encode(), fin=is_last)
        return self.sent()

    def rest(self, text: str, *, is_last: bool = True) -> bytes:
        self.protocol.send_continuation(text.encode(), fin=is_last)
        return self.sent()

    def receive(self, data: bytes) -> list[Frame | Response]:
        self.protocol.receive_data(data)
        return self.protocol.events_received()


async def open_socket(
    client: PlayedClient, line: ScriptedLine, *, access: Access = OPEN_ACCESS, rules: Quotas = RULES, files=None
) -> tuple[WebSocket, bool]:
    """Return the socket after its handshake, and whether it showed the token."""
    web = WebSocket(line, client.request, rules)
    has_token = await web.open(access, lambda token: token == TOKEN, AUTHORITIES, files or {})
    client.receive(line.take())
    return web, has_token


def answer_of(client: PlayedClient, line: ScriptedLine) -> Response:
    (response,) = client.receive(line.take())
    assert isinstance(response, Response)
    return response


@pytest.mark.parametrize(
    ("client", "access", "has_token"),
    [
        (PlayedClient(), Access(), False),
        (PlayedClient(), Access(TOKEN), False),
        (PlayedClient(token=TOKEN), Access(TOKEN), True),
        (PlayedClient(token=TOKEN, host="any.name:1"), Access(TOKEN), True),
        (PlayedClient(token="wrong"), Access(), False),
        (PlayedClient(origin="http://robot:8000"), Access(), False),
        (PlayedClient(token=TOKEN, origin="http://robot:8000"), Access(TOKEN), True),
    ],
)
def test_websocket_requests_of_permitted_clients_are_accepted(
    client: PlayedClient, access: Access, has_token: bool
) -> None:
    line = ScriptedLine()

    async def run() -> bool:
        web = WebSocket(line, client.request, Quotas())
        return await web.open(access, lambda token: token == TOKEN, AUTHORITIES)

    assert asyncio.run(run()) == has_token
    assert answer_of(client, line).status_code == 101
    assert not line.closed


@pytest.mark.parametrize(
    ("client", "access", "status"),
    [
        (PlayedClient(token="wrong"), Access(TOKEN), 401),
        (PlayedClient(host="any.name:1"), Access(), 421),
        (PlayedClient(origin="http://elsewhere"), Access(), 403),
        (PlayedClient(token=TOKEN, origin="http://elsewhere"), Access(TOKEN), 403),
        (PlayedClient(token=TOKEN, host="any.name:1", origin="http://any.name:1"), Access(TOKEN), 421),
    ],
)
def test_websocket_requests_of_foreign_clients_are_refused_with_the_reason(
    client: PlayedClient, access: Access, status: int
) -> None:
    line = ScriptedLine()
    with pytest.raises(HalfError):
        asyncio.run(open_socket(client, line, access=access))
    response = answer_of(client, line)
    assert response.status_code == status
    assert response.body.endswith(b"\n")
    assert line.closed


def test_request_with_two_token_headers_is_refused() -> None:
    line, client = ScriptedLine(), PlayedClient(token=TOKEN)
    doubled = client.request.replace(b"\r\n\r\n", f"\r\nAuthorization: Bearer {TOKEN}\r\n\r\n".encode())
    client.request = doubled
    with pytest.raises(HalfError):
        asyncio.run(open_socket(client, line, access=Access(TOKEN)))
    assert answer_of(client, line).status_code == 401


def test_http_request_may_arrive_in_pieces_and_is_read_with_a_time_limit() -> None:
    client = PlayedClient()
    begin, end = client.request[:30], client.request[30:]
    line, client.request = ScriptedLine(end), begin
    asyncio.run(open_socket(client, line))
    assert line.hurries == [True]


def test_incomplete_http_request_is_reported() -> None:
    client = PlayedClient()
    client.request = client.request[:30]
    with pytest.raises(HalfError, match="the connection ended"):
        asyncio.run(open_socket(client, ScriptedLine()))


@pytest.mark.parametrize(("files", "status"), [(PAGE, b"200"), ({}, b"426")])
def test_browser_gets_the_page_or_an_error_status_if_the_server_has_no_files(
    files: dict[str, WebFile], status: bytes
) -> None:
    line, client = ScriptedLine(), PlayedClient()
    client.request = b"GET / HTTP/1.1\r\nHost: robot:8000\r\n\r\n"
    with pytest.raises(HalfError):
        asyncio.run(open_socket(client, line, files=files))
    head, body = line.take().split(b"\r\n\r\n", 1)
    assert head.split()[1] == status
    assert (body == b"<p>Robot</p>") == bool(files)
    assert line.closed


def test_server_with_files_still_accepts_websockets() -> None:
    line, client = ScriptedLine(), PlayedClient()
    asyncio.run(open_socket(client, line, files=PAGE))
    assert not line.closed


async def collect(messages: AsyncIterator[bytes]) -> list[bytes]:
    return [message async for message in messages]


def exchange(*chunks: list[bytes], rules: Quotas = RULES, hurry: bool = False) -> tuple[list[bytes], ScriptedLine]:
    """Return the messages of a client that sends frames, and the line."""
    line = ScriptedLine()

    async def run() -> list[bytes]:
        web, _ = await open_socket(PlayedClient(), line, rules=rules)
        line.chunks += [b"".join(chunk) for chunk in chunks]
        return await collect(web.messages(lambda: hurry))

    return asyncio.run(run()), line


def frame(opcode: int, data: bytes, *, is_last: bool = True) -> bytes:
    return Frame(opcode, data, fin=is_last).serialize(mask=True)


def test_websocket_messages_may_be_text_bytes_or_fragments() -> None:
    fragments = [frame(OP_TEXT, b"thr", is_last=False), frame(OP_CONT, b"e", is_last=False), frame(OP_CONT, b"e")]
    messages, line = exchange([frame(OP_TEXT, b"one"), frame(OP_BINARY, b"two")], fragments[:1], fragments[1:])
    assert messages == [b"one", b"two", b"three"]
    assert line.hurries == [False, False, True, False]


def test_websocket_read_is_urgent_only_while_a_frame_is_incomplete() -> None:
    whole = frame(OP_TEXT, b"text")
    messages, line = exchange([whole[:4]], [whole[4:]])
    assert messages == [b"text"]
    assert line.hurries == [False, True, False]
    assert exchange([whole], hurry=True)[1].hurries == [True, True]


def test_websocket_ping_is_answered_and_not_passed_on() -> None:
    messages, line = exchange([Frame(9, b"there?").serialize(mask=True), frame(OP_TEXT, b"text")])
    assert messages == [b"text"]
    assert line.written == Frame(10, b"there?").serialize(mask=False)


def test_websocket_close_is_answered_and_ends_the_messages() -> None:
    closing = Frame(8, (1000).to_bytes(2, "big")).serialize(mask=True)
    messages, line = exchange([frame(OP_TEXT, b"text"), closing], [frame(OP_TEXT, b"never read")])
    assert messages == [b"text"]
    assert line.written[0] == 0x88
    assert line.hurries == [False]


def test_websocket_message_may_be_as_long_as_the_limit_and_no_longer() -> None:
    assert exchange([frame(OP_TEXT, b"12345")], rules=Quotas(message=5))[0] == [b"12345"]
    with pytest.raises(ValueError, match="at most 5 bytes are read"):
        exchange([frame(OP_TEXT, b"123456")], rules=Quotas(message=5))


def test_number_of_websocket_frames_per_time_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kinesic.serve.wire.quotas.monotonic", lambda: 0.0)
    four = [frame(OP_TEXT, b"x")] * 4
    assert len(exchange(four, rules=Quotas(fragments=4))[0]) == 4
    with pytest.raises(ValueError, match="at most 4 frames at once and 2 a second"):
        exchange([*four, frame(OP_TEXT, b"x")], rules=Quotas(fragments=4))


def test_websocket_frame_limit_recovers_with_time(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([0.0, 0.0, 0.0, 0.0, 0.0, 1.01, 1.01, 1.01])
    monkeypatch.setattr("kinesic.serve.wire.quotas.monotonic", lambda: next(times))
    assert len(exchange([frame(OP_TEXT, b"x")] * 6, rules=Quotas(fragments=4))[0]) == 6


def test_other_server_tasks_run_while_many_websocket_frames_are_parsed(monkeypatch: pytest.MonkeyPatch) -> None:
    pauses: list[float] = []

    async def note_pause(seconds: float) -> None:
        pauses.append(seconds)

    monkeypatch.setattr(websocket, "sleep", note_pause)
    messages, _ = exchange([frame(OP_TEXT, b"x" * 94)] * (5 * PARSE_SIZE // 100))
    assert len(messages) == 5 * PARSE_SIZE // 100
    assert pauses == [0] * 4


def test_lost_connection_gets_no_close_frame() -> None:
    async def run() -> bytes:
        line = ScriptedLine()
        web, _ = await open_socket(PlayedClient(), line)
        await collect(web.messages(lambda: False))
        await web.close(1000, "")
        return line.written

    assert asyncio.run(run()) == b""


def test_websocket_sends_messages_until_it_is_closed() -> None:
    async def run() -> tuple[bytes, bytes, bool]:
        line, client = ScriptedLine(), PlayedClient()
        web, _ = await open_socket(client, line)
        moved = ScriptedLine()
        web.move(moved)
        await web.send("<bml/>")
        sent = moved.take()
        await web.close(1013, "w" * 200)
        closing = moved.take()
        await web.send("too late")
        await web.close(1000, "")
        assert moved.written == line.written == b""
        return sent, closing, moved.closed

    sent, closing, closed = asyncio.run(run())
    assert sent == Frame(OP_TEXT, b"<bml/>").serialize(mask=False)
    assert closing == Frame(8, (1013).to_bytes(2, "big") + b"w" * 100).serialize(mask=False)
    assert closed


def test_websocket_client_receives_nothing_after_it_ended_sending() -> None:
    assert not WebSocket(ScriptedLine(), b"", Quotas()).lingers
