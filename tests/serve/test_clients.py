"""What clients may not do: each is refused by a rule that is named, and the others notice nothing."""

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


def test_without_the_token_nothing_is_taken(guarded):
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


def test_an_emergency_stop_needs_the_token_too(guarded):
    with Client(port=guarded.port) as client:
        client.stop()
        assert json.loads(client.receive(20))["told"] == "refused"
    assert not guarded.open.clients.session.loop.halted


def test_with_the_token_it_is_as_ever(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        assert re.search(r'id="welcome:end"', list(client.perform(BLOCK.format("welcome", NOD)))[-1])
    with connect(f"ws://127.0.0.1:{guarded.port}", additional_headers={"Authorization": "Bearer open sesame"}) as web:
        web.send('{"do": "ping"}')
        assert "pong" in web.recv(20)


def test_whoever_says_nothing_is_sent_away(guarded):
    with socket.create_connection(("127.0.0.1", guarded.port), 20) as silent:
        assert silent.makefile("rb").read() == b""


def test_an_oversized_block_is_refused_by_tcp(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        client.send("<bml>" + "x" * 3000)
        assert "rule message" in client.receive(20)
        assert json.loads(client.receive(20))["code"] == 1009


def test_an_oversized_block_is_refused_by_websocket(guarded):
    headers = {"Authorization": "Bearer open sesame"}
    with connect(f"ws://127.0.0.1:{guarded.port}", additional_headers=headers) as web:
        web.send("<bml>" + "x" * 3000)
        with pytest.raises(ConnectionClosed) as closed:
            web.recv(20)
    assert closed.value.rcvd.code == 1009


def test_a_block_that_is_too_deep_is_refused(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        client.send("<a>" * 10 + "</a>" * 10)
        assert "at most 8 are read" in client.receive(20)


def test_a_block_that_lasts_too_long_is_refused(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        client.send(BLOCK.format("endless", '<gesture id="g" lexeme="BEAT" stroke="30"/>'))
        assert "rule duration: endless lasts 31 s, at most 20 s are taken" in client.receive(20)


@pytest.mark.parametrize("ends", [True, False])
def test_half_a_message_is_refused(guarded, ends):
    with socket.create_connection(("127.0.0.1", guarded.port), 20) as plain:
        plain.sendall(b'{"do": "hello", "token": "open sesame"}\0<bml id="b">')
        if ends:
            plain.shutdown(socket.SHUT_WR)
        stream = plain.makefile("rb").read().decode()
    assert "rule half" in stream
    assert "1008" in stream


def test_too_many_messages_are_refused_one_by_one(guarded):
    with Client(port=guarded.port, token="open sesame") as client:
        for _ in range(40):
            client.do("ping")
        answers = [client.receive(20) for _ in range(40)]
    assert 9 <= sum("pong" in answer for answer in answers) < 40
    assert any("rule rate" in answer for answer in answers)


@pytest.fixture
def full(guarded, becomes):
    """A server all of whose places are taken."""
    assert becomes(lambda: not guarded.open.clients._clients)
    clients = [Client(port=guarded.port, token="open sesame") for _ in range(4)]
    yield guarded
    for client in clients:
        client.close()
    assert becomes(lambda: not guarded.open.clients._clients)


def test_too_many_clients_are_sent_away(full):
    with Client(port=full.port, token="open sesame") as more:
        more.do("ping")
        assert json.loads(more.receive(20))["code"] == 1013


def test_whoever_shows_the_token_may_stop_even_where_all_places_are_taken(full, becomes):
    loop = full.open.clients.session.loop
    with Client(port=full.port, token="open sesame") as more:
        more.stop()
        assert json.loads(more.receive(20)) == {"told": "stopped"}
        assert becomes(lambda: loop.halted)
    full.tasks.call_soon_threadsafe(full.open.clients.session.resume)
    assert becomes(lambda: not loop.halted)


def test_a_stop_that_nobody_makes_is_told_as_such(guarded, monkeypatch):
    def fail() -> None:
        raise RuntimeError("the loop that moves it has ended")

    monkeypatch.setattr(guarded.open.clients.session, "halt", fail)
    with Client(port=guarded.port, token="open sesame") as client:
        client.stop()
        answer = json.loads(client.receive(20))
    assert answer["told"] == "failed"
    assert "may not stop (the loop that moves it has ended): use the switch" in answer["why"]


def test_whoever_does_not_show_it_takes_no_place(guarded):
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


def test_who_goes_on_after_refusals_is_sent_away(guarded):
    with Client(port=guarded.port, token="open sesame") as client, suppress(OSError):
        for _ in range(400):
            client.do("ping")
        answers = []
        while '"closed"' not in (answer := client.receive(20)):
            answers.append(answer)
        assert json.loads(answer)["why"] == "rule rate: too many messages were refused"
        assert sum("rule rate" in each for each in answers) >= 30


def test_a_client_that_never_reads_is_sent_away(guarded, becomes):
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
        told = never.receive(20)
        assert told.startswith("x") or "messages were dropped" in told
