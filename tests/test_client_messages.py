"""Client with a scripted server: framing, ends of blocks and failures."""

import json
import socket
from collections.abc import Callable, Iterator
from contextlib import suppress
from threading import Event, Thread
from time import sleep

import pytest

from kinesic import client as module
from kinesic import client_feedback
from kinesic.client import DEFAULT_PORT, Client, StopLine
from kinesic.realizer.request import block_id

END = '<blockProgress xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}:end" globalTime="1"/>'


class Server:
    """Server end of a client's connection."""

    def __init__(self, end: socket.socket) -> None:
        self._end = end

    def say(self, *messages: str) -> None:
        self._end.sendall(b"".join(message.encode() + b"\0" for message in messages))

    def say_bytes(self, data: bytes) -> None:
        self._end.sendall(data)

    def heard(self) -> list[str]:
        self._end.setblocking(False)
        try:
            *messages, rest = self._end.recv(1 << 20).split(b"\0")
        except BlockingIOError:
            return []
        assert rest == b"", "every message ends"
        return [message.decode() for message in messages]

    def leave(self) -> None:
        self._end.close()


@pytest.fixture
def asked() -> list[tuple]:
    """List the addresses and timeouts of all connection attempts."""
    return []


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch, asked: list[tuple]) -> Iterator[Server]:
    ours, theirs = socket.socketpair()
    theirs.settimeout(10.0)

    def connect(address: tuple, timeout: float) -> socket.socket:
        asked.append((*address, timeout))
        return theirs

    monkeypatch.setattr(module.socket, "create_connection", connect)
    yield Server(ours)
    ours.close()
    theirs.close()


def test_client_connects_to_localhost_by_default(server: Server, asked: list[tuple]):
    Client()
    Client("robot", 99, timeout=2.0)
    assert asked == [("127.0.0.1", DEFAULT_PORT, 10.0), ("robot", 99, 2.0)]
    assert DEFAULT_PORT == 8864
    assert server.heard() == [], "nothing is said without a token"


def test_client_sends_its_token_before_other_messages(server: Server):
    server.say('{"told":"welcome"}')
    Client(token="open sesame").do("ping", id="x")
    assert [json.loads(item) for item in server.heard()] == [
        {"do": "hello", "token": "open sesame"},
        {"do": "ping", "id": "x"},
    ]


@pytest.mark.parametrize(
    ("answer", "why"),
    [('{"told":"refused","why":"the token is wrong"}', "is wrong"), ('{"told":"x"}', "does not answer")],
)
def test_client_with_a_refused_token_raises_an_error_and_closes_the_connection(server: Server, answer: str, why: str):
    server.say(answer)
    with pytest.raises(PermissionError, match=why):
        Client(token="guess")
    server.heard()
    assert server._end.recv(1) == b"", "it is closed"


def test_client_raises_an_error_if_the_server_does_not_answer_the_token(server: Server):
    with pytest.raises(PermissionError, match="does not answer"):
        Client(token="guess", timeout=0.01)


def test_client_splits_messages_correctly_for_any_division_into_network_chunks(server: Server):
    client, stream = Client(), "<a/>\0 <b>\u00e4</b>\n\0<c/>\0".encode()
    for k in range(len(stream)):
        server.say_bytes(stream[k : k + 1])
    assert [client.receive(1.0) for _ in range(3)] == ["<a/>", "<b>\u00e4</b>", "<c/>"]
    assert client.receive(0.0) is None


def test_client_returns_a_message_only_when_it_is_complete(server: Server):
    client = Client()
    server.say_bytes(b"<a")
    assert client.receive(0.01) is None
    server.say_bytes(b"/>\0<b/>\0<c")
    assert client.receive(1.0) == "<a/>"
    assert client.receive(0.0) == "<b/>"
    assert client.receive(0.0) is None
    server.say_bytes(b"/>\0")
    assert client.receive(1.0) == "<c/>"


def test_client_raises_an_error_only_after_the_last_message_of_a_closed_connection(server: Server):
    client = Client()
    server.say("<a/>")
    server.leave()
    assert client.receive(1.0) == "<a/>"
    with pytest.raises(ConnectionError, match="has closed the connection"):
        client.receive(1.0)


def test_client_stop_method_sends_one_stop_message(server: Server):
    Client().stop()
    assert server.heard() == ['{"do": "stop"}']


@pytest.mark.parametrize(
    ("document", "name"),
    [
        ('<bml id="b1"/>', "b1"),
        ("<bml id='b1'/>", "b1"),
        ('<x:bml xmlns:x="u" id = "b1">', "b1"),
        ('<bml xmlns="u"\n  composition="APPEND" id="b1">', "b1"),
        ('<bml character="id" id="b1"><head id="h"/></bml>', "b1"),
        ('{"id": "b1"}', "b1"),
        (' {"id": 7}', "7"),
        ("{}", "block"),
        ("{", "block"),
        ('<bml><head id="h"/></bml>', "block"),
        ("words", "block"),
        ('<!-- <bml id="old"/> --><bml id="b1"/>', "b1"),
        ("<bml id='a&amp;b'/>", "a&amp;b"),
        ("<bml id=' it&apos;s &#65; \"B\" '/>", "it's A &quot;B&quot;"),
        ('<!DOCTYPE bml [<!ENTITY e "b1">]><bml id="&e;"/>', "b1"),
        ('<a><![CDATA[<bml id="old">]]><bml title=\'x id="y"\' id="b1"/></a>', "b1"),
        ('<bml <!-- <bml id="old"> --><bml id="b1', "block"),
    ],
)
def test_client_perform_returns_messages_up_to_the_end_of_its_block(server: Server, document: str, name: str):
    client = Client()
    others = ["<x/>", END.format(f"{name}2"), END.format(name).replace(":end", ":start"), "<!-- -->" + END.format(name)]
    server.say(*others, END.format(name), "<later/>")
    assert list(client.perform(document)) == [*others, END.format(name)]
    assert server.heard() == [document]
    assert client.receive(0.0) == "<later/>"


DOCUMENTS = (
    *(
        '<bml id="b"/>',
        "<bml id='it\"s'/>",
        "<bml id='a&amp;b'/>",
        '<bml id=" "/>',
        "<bml/>",
        "",
        "words",
        "{",
        '{"id": "j"}',
    ),
    *('<!-- <bml id="old"> --><bml id="new">', '<!-- <bml id="old">', '<a><![CDATA[<bml id="old">]]><bml id="b"></a>'),
    *(
        '<x:bml id="b">',
        "<bml " * 10 + ' id="late">',
        '<bml id="&#65;&unknown;"/>',
        '<bml id="b" id="c"/>',
        '<bml id="b"',
    ),
    *(
        "<a/>" * 100_000 + '<bml id="far">',
        '<bml id="b"><head',
        '<fml-apml><bml id="b"/></fml-apml>',
        '<?xml version="1.0"',
    ),
)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda text: text[:40])
def test_client_and_server_derive_the_same_block_id(document: str):
    assert client_feedback.document_id(document) == block_id(document)


WARNING = '<warningFeedback xmlns="u" id="{}" type="{}">{}</warningFeedback>'


@pytest.mark.parametrize(
    ("warning", "ends"),
    [
        (WARNING.format("b1", "PARSING_FAILURE", "line 1"), True),
        (WARNING.format("b1", "IMPOSSIBLE_TO_SCHEDULE", "rule waiting: 9 wait"), True),
        (WARNING.format("b1", "IMPOSSIBLE_TO_SCHEDULE", "not performed: no"), True),
        (WARNING.format("b1", "IMPOSSIBLE_TO_SCHEDULE", "b1:h comes later"), False),
        (WARNING.format("b2", "PARSING_FAILURE", "line 1"), False),
        (WARNING.format("b1:h", "IMPOSSIBLE_TO_SCHEDULE", "rule x: y"), False),
        (WARNING.format("b1", "CANNOT_CREATE_BEHAVIOR", "as rule x: y says"), False),
        (WARNING.format("b1", "PARSING_FAILURE", "x").replace("warningFeedback", "otherFeedback"), False),
    ],
)
def test_client_perform_ends_after_a_warning_only_if_the_warning_refuses_the_block(
    server: Server, warning: str, ends: bool
):
    client = Client()
    server.say(warning, END.format("b1"))
    assert list(client.perform('<bml id="b1"/>')) == [warning] + [END.format("b1")] * (not ends)


def test_leaving_the_with_block_of_a_client_closes_the_connection(server: Server):
    with Client() as client:
        client.send("<bml/>")
    assert server._end.recv(100) == b"<bml/>\0"
    assert server._end.recv(1) == b""


@pytest.fixture
def line(server: Server) -> Callable[[], StopLine]:
    def make() -> StopLine:
        server.say('{"told":"stop_line"}')
        result = StopLine()
        assert server.heard() == ['{"do": "stop_line"}']
        return result

    return make


def test_emergency_stop_connection_sends_one_stop_and_accepts_the_acknowledgement(
    server: Server, line: Callable[[], StopLine]
):
    stopping = line()
    server.say('{"told":"stopped"}')
    stopping.stop()
    assert server.heard() == ['{"do": "stop"}']


@pytest.mark.parametrize(
    ("answer", "why"), [('{"told":"failed","why":"use the switch"}', "use the switch"), ('{"told":"x"}', "answers")]
)
def test_emergency_stop_of_a_client_that_is_refused_or_answered_wrongly_raises_an_error(
    server: Server, line: Callable[[], StopLine], answer: str, why: str
):
    stopping = line()
    server.say(answer)
    with pytest.raises(ConnectionError, match=why):
        stopping.stop()


def test_emergency_stop_without_answer_raises_an_error_and_a_late_answer_is_ignored(
    server: Server, line: Callable[[], StopLine]
):
    stopping = line()
    with pytest.raises(ConnectionError, match=r"no answer came in 0\.01 s"):
        stopping.stop(0.01)
    server.say('{"told":"stopped"}', '{"told":"failed","why":"the second"}')
    with pytest.raises(ConnectionError, match="the second"):
        stopping.stop()
    server.say('{"told":"stopped"}')
    stopping.stop()
    assert server.heard() == ['{"do": "stop"}'] * 3


def test_refused_emergency_stop_connection_is_closed(server: Server):
    server.say('{"told":"refused","why":"too many stop lines"}')
    with pytest.raises(ConnectionError, match="too many stop lines"):
        StopLine()
    server.heard()
    assert server._end.recv(1) == b""


def test_leaving_the_with_block_of_an_emergency_stop_connection_closes_it(server: Server, line: Callable[[], StopLine]):
    with line():
        pass
    assert server._end.recv(1) == b""


def test_closing_a_client_ends_its_receive_call_in_another_thread():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        client = Client("127.0.0.1", listener.getsockname()[1])
        ended = Event()

        def receive() -> None:
            with suppress(OSError, ValueError):
                client.receive()
            ended.set()

        Thread(target=receive, daemon=True).start()
        sleep(0.05)  # so that it waits
        client.close()
        assert ended.wait(5)
