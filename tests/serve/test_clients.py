"""Limits for clients over the wire, and their named refusals."""

import json
import re
import socket
from contextlib import suppress

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from kinesic.client import Client

pytestmark = pytest.mark.realtime

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="0"/>'


def test_server_with_a_token_accepts_no_message_without_the_token(guarded):
    with Client(port=guarded.port) as client:
        client.send(BLOCK.format("b", NOD))
        assert "a token is needed" in json.loads(client.receive(20))["why"]
        assert json.loads(client.receive(20))["code"] == 1008
        with pytest.raises(ConnectionError):
            client.receive(20)
    with pytest.raises(PermissionError, match="the token is wrong"):
        Client(port=guarded.port, token="guess")
    with pytest.raises(InvalidStatus, match="401"):
        connect(f"ws://127.0.0.1:{guarded.port}", additional_headers={"Authorization": "Bearer guess"})


def test_emergency_stop_request_without_the_token_is_refused(guarded):
    with Client(port=guarded.port) as client:
        client.stop()
        assert json.loads(client.receive(20))["told"] == "refused"
    assert not guarded.open.clients.session.loop.is_stopped


def test_client_with_the_token_may_send_blocks_and_pings(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        assert re.search(r'id="welcome:end"', list(client.perform(BLOCK.format("welcome", NOD)))[-1])
    with connect(f"ws://127.0.0.1:{guarded.port}", additional_headers={"Authorization": "Bearer open sesame"}) as web:
        web.send('{"do": "ping"}')
        assert "pong" in web.recv(20)


def test_silent_tcp_client_is_disconnected_by_the_server(guarded):
    with socket.create_connection(("127.0.0.1", guarded.port), 20) as silent:
        assert silent.makefile("rb").read() == b""


def test_oversized_block_is_refused_over_tcp(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        client.send("<bml>" + "x" * 3000)
        assert "rule message" in client.receive(20)
        assert json.loads(client.receive(20))["code"] == 1009


def test_oversized_block_is_refused_over_websocket(guarded):
    headers = {"Authorization": "Bearer open sesame"}
    with connect(f"ws://127.0.0.1:{guarded.port}", additional_headers=headers) as web:
        web.send("<bml>" + "x" * 3000)
        with pytest.raises(ConnectionClosed) as closed:
            web.recv(20)
    assert closed.value.rcvd.code == 1009


def test_too_deeply_nested_block_is_refused(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        client.send("<a>" * 10 + "</a>" * 10)
        assert "the limit is 8 levels" in client.receive(20)


def test_block_beyond_the_duration_quota_is_refused(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        client.send(BLOCK.format("endless", '<gesture id="g" lexeme="BEAT" stroke="30"/>'))
        assert "rule duration: endless lasts 31 s, at most 20 s are taken" in client.receive(20)


@pytest.mark.parametrize("ends", [True, False])
def test_incomplete_message_of_a_tcp_client_is_refused(guarded, ends):
    with socket.create_connection(("127.0.0.1", guarded.port), 20) as plain:
        plain.sendall(b'{"do": "hello", "token": "open sesame"}\0<bml id="b">')
        if ends:
            plain.shutdown(socket.SHUT_WR)
        stream = plain.makefile("rb").read().decode()
    assert "rule half" in stream
    assert "1008" in stream


def test_messages_beyond_the_rate_limit_are_refused_one_by_one(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        for _ in range(40):
            client.do("ping")
        answers = [client.receive(20) for _ in range(40)]
    assert 9 <= sum("pong" in answer for answer in answers) < 40
    assert any("rule rate" in answer for answer in answers)


@pytest.fixture
def full(guarded, becomes):
    """Server whose client slots are all taken."""
    assert becomes(lambda: not guarded.open.clients._clients)
    clients = [Client(port=guarded.port, token="open sesame") for _ in range(4)]
    yield guarded
    for client in clients:
        client.close()
    assert becomes(lambda: not guarded.open.clients._clients)


def test_clients_beyond_the_limit_are_disconnected(full):
    with Client(port=full.port, token="open sesame") as more:
        more.do("ping")
        assert json.loads(more.receive(20))["code"] == 1013


def test_client_with_token_may_stop_the_robot_when_all_client_slots_are_taken(full, becomes):
    loop = full.open.clients.session.loop
    with Client(port=full.port, token="open sesame") as more:
        more.stop()
        assert json.loads(more.receive(20)) == {"told": "stopped"}
        assert becomes(lambda: loop.is_stopped)
    full.tasks.call_soon_threadsafe(full.open.clients.session.resume)
    assert becomes(lambda: not loop.is_stopped)


def test_failed_emergency_stop_is_reported_to_the_sender(guarded, monkeypatch):
    def fail() -> None:
        raise RuntimeError("the control loop has ended")

    monkeypatch.setattr(guarded.open.clients.session, "emergency_stop", fail)
    with Client(port=guarded.port, token="open sesame") as client:
        client.stop()
        answer = json.loads(client.receive(20))
    assert answer["told"] == "failed"
    assert "may not stop (the control loop has ended): use the switch" in answer["why"]


def test_client_without_token_occupies_no_client_slot(guarded):
    strangers = [Client(port=guarded.port) for _ in range(8)]
    try:
        for stranger in strangers:
            stranger.send_bytes(b"<")
        with Client(port=guarded.port, token="open sesame") as client:
            client.do("status")
            assert json.loads(client.receive(20))["clients"] == 1
    finally:
        for stranger in strangers:
            stranger.close()


def test_client_that_continues_after_refusals_is_disconnected(guarded):
    with Client(port=guarded.port, token="open sesame") as client, suppress(OSError):
        for _ in range(400):
            client.do("ping")
        answers = []
        while '"closed"' not in (answer := client.receive(20)):
            answers.append(answer)
        assert json.loads(answer)["why"] == "rule rate: too many messages were refused"
        assert sum("rule rate" in answer for answer in answers) >= 30


def test_client_that_never_reads_is_disconnected(guarded, becomes):
    assert becomes(lambda: not guarded.open.clients._clients)
    with (
        Client(port=guarded.port, token="open sesame") as never,
        Client(port=guarded.port, token="open sesame") as other,
    ):
        assert becomes(lambda: len(guarded.open.clients._clients) == 2)
        client = min(guarded.open.clients._clients.values(), key=lambda each: each.number)
        for _ in range(300):
            guarded.tasks.call_soon_threadsafe(client.send, "x" * 50_000)
        assert becomes(lambda: client.number not in guarded.open.clients._clients)
        other.do("ping")
        assert "pong" in other.receive(20)
        message = never.receive(20)
        assert message.startswith("x") or "messages were dropped" in message


def test_status_reports_playing_blocks_with_their_remaining_seconds(server):
    with server.client() as client:
        client.send(BLOCK.format("seen", NOD))
        while "blockProgress" not in client.receive(20):
            pass
        client.do("status")
        while not (message := client.receive(20)).startswith("{"):
            pass
    (block,) = [load for load in json.loads(message)["blocks"] if load["block"] == "seen"]
    assert block["starts_in"] == 0
    assert 0 < block["ends_in"] < 5
