"""WebSocket handshakes: only programs and pages of the server are admitted."""

import socket

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from kinesic.serve.wire.origin import Access

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="smuggled"><head id="h" lexeme="NOD" start="0"/></bml>'


@pytest.fixture
def reached(server, monkeypatch):
    """Messages that reached the session, from any client."""
    results = []
    monkeypatch.setattr(server.open.clients, "receive", lambda client, message: results.append(message))
    return results


def test_web_page_of_an_allowed_origin_may_connect(server, monkeypatch, tmp_path):
    named = "http://studio.example:5173"
    monkeypatch.setattr(server.open.clients, "access", Access(origins=frozenset({named})))
    assert handshake(server.port, "localhost", f"Origin: {named}").startswith(b"HTTP/1.1 101")
    assert handshake(server.port, "localhost", "Origin: http://studio.example").startswith(b"HTTP/1.1 403")


def handshake(port: int, host: str, *lines: str) -> bytes:
    """Return the server's answer to a WebSocket request."""
    lines = (
        "GET / HTTP/1.1",
        f"Host: {host}:{port}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
        "Sec-WebSocket-Version: 13",
        *lines,
    )
    return answer(port, "\r\n".join((*lines, "", "")).encode(), ends=False)


def answer(port: int, said: bytes, *, ends: bool = True) -> bytes:
    """Return the received bytes until the server closes or has answered."""
    with socket.create_connection(("127.0.0.1", port), 20) as client:
        client.sendall(said)
        if ends:
            client.shutdown(socket.SHUT_WR)
            return client.makefile("rb").read()
        return client.recv(65_536)


@pytest.mark.parametrize(
    ("host", "lines", "status"),
    [
        ("localhost", (), 101),
        ("LOCALHOST", (), 101),
        ("evil.example", (), 421),
        ("localhost.", (), 421),
        ("localhost", ("Origin: null",), 403),
        ("localhost", ("ORIGIN: http://localhost:1",), 403),
        ("localhost", ("Origin: null", "Origin: http://localhost"), 400),
        ("localhost", ("Host: evil.example",), 400),
        ("localhost", ("Authorization: Bearer guess", "Origin: null"), 403),
        ("localhost", ("Authorization: Bearer \xff",), 101),
    ],
)
def test_websocket_handshake_status_depends_on_host_origin_and_headers(server, host, lines, status):
    assert handshake(server.port, host, *lines).startswith(b"HTTP/1.1 %d" % status)


@pytest.mark.parametrize(
    ("lines", "status"),
    [
        (("Authorization: Bearer open sesame", "Origin: null"), 403),
        (("Authorization: Bearer open sesame",), 101),
        (("Authorization: Bearer guess",), 401),
        (("Authorization: Bearer open sesame", "Authorization: Bearer guess"), 401),
        (("Origin: https://evil.example",), 403),
        ((), 101),
    ],
)
def test_handshake_status_of_a_server_with_token_depends_on_origin_and_token(guarded, lines, status):
    assert handshake(guarded.port, "localhost", *lines).startswith(b"HTTP/1.1 %d" % status)


def test_program_with_token_may_use_any_host_name(guarded):
    known = handshake(guarded.port, "robot.local", "Authorization: Bearer open sesame")
    assert known.startswith(b"HTTP/1.1 101")
    assert handshake(guarded.port, "robot.local").startswith(b"HTTP/1.1 421")


@pytest.mark.parametrize("method", ["POST", "PUT", "OPTIONS", "get", "HEAD", "PRI", "CONNECT", "*", "GET"])
def test_body_of_an_http_request_is_not_read_as_control_messages(server, reached, method):
    body = f'\0{{"do": "stop"}}\0{NOD}\0'
    request = f"{method} / HTTP/1.1\r\nHost: localhost:{server.port}\r\nContent-Length: {len(body)}\r\n\r\n{body}"
    assert not answer(server.port, request.encode()).startswith(b"HTTP/1.1 101")
    assert reached == []


@pytest.mark.parametrize("first", [b"\0\1\0\0!\x12\xa4B", b"\x16\3\1\2\0\1", b"\0", b"\x80\x80", b"[", b"stop"])
def test_data_of_other_protocols_is_not_read_as_messages(server, reached, first):
    """STUN and TURN over TCP begin with NUL, TLS with 22."""
    assert answer(server.port, first + b"\0" + NOD.encode() + b"\0") == b""
    assert reached == []


def test_websocket_with_endless_empty_fragments_is_closed(server):
    with connect(f"ws://127.0.0.1:{server.port}") as client:
        with pytest.raises(ConnectionClosed) as closed:
            client.send("" for _ in range(100_000))
        assert closed.value.rcvd.code == 1009
        assert "at most 1000 frames at once" in closed.value.rcvd.reason
