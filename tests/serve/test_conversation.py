"""Conversations with one client over a simulated connection."""

import asyncio
import json
from collections.abc import AsyncIterator, Callable

import pytest

from kinesic.serve.clients import CLOSE_NORMAL, CLOSE_POLICY_VIOLATION, CLOSE_TOO_BIG, ConnectedClient
from kinesic.serve.conversation import serve_client
from kinesic.serve.wire.origin import OPEN_ACCESS
from kinesic.serve.wire.quotas import Quotas
from kinesic.serve.wire.transport import HalfError

from .played_registry import TOKEN_ACCESS, Registry

RULES = Quotas()
PATIENCE = 20.0  # [s] longest wait for a condition that a test expects
DOCUMENT = b"<bml/>"


class PlayedWire:
    """Connection that yields prepared messages, and then ends, fails or stays open."""

    def __init__(
        self, *messages: bytes, lingers: bool = True, fault: Exception | None = None, stays_open: bool = False
    ) -> None:
        self.lingers, self._messages, self._fault, self._stays_open = lingers, messages, fault, stays_open
        self.sent: list[str] = []
        self.hurries: list[bool] = []
        self.closed: list[tuple[int, str]] = []
        self.is_reading = False
        self.refuses_output = False

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        self.is_reading = True
        try:
            for message in self._messages:
                self.hurries.append(hurry())
                yield message
            if self._fault is not None:
                raise self._fault
            if self._stays_open:
                await asyncio.Event().wait()
        finally:
            self.is_reading = False

    async def send(self, message: str) -> None:
        if self.refuses_output:
            raise TimeoutError("the client does not read")
        self.sent.append(message)

    async def close(self, code: int, why: str) -> None:
        assert not self.is_reading
        self.closed.append((code, why))


class Conversation:
    """A client that is attended, with the registry that processes its messages."""

    def __init__(self, wire: PlayedWire, access=OPEN_ACCESS, *, unfinished: int = 0) -> None:
        self.wire, self.registry = wire, Registry(access, RULES)
        self.client: ConnectedClient = self.registry.join("a")
        self.notices = 0
        self.polls = unfinished
        self.registry.session.has_unfinished_blocks = self._has_unfinished_blocks

    def _has_unfinished_blocks(self, number: int) -> bool:
        assert number == self.client.number
        self.polls -= 1
        if self.polls == 0:
            self.client.send("end of the block")
        return self.polls >= 0

    def notice(self) -> None:
        self.notices += 1

    def hold(self) -> "Conversation":
        async def run() -> None:
            async with asyncio.timeout(PATIENCE):
                await serve_client(self.registry, self.wire, self.client, notice=self.notice)
            assert asyncio.all_tasks() == {asyncio.current_task()}, "no task is left over"

        asyncio.run(run())
        assert self.client.number not in self.registry._clients
        return self


def test_messages_of_a_client_are_processed_in_order_and_pings_answered() -> None:
    wire = PlayedWire(b'{"do": "ping", "id": "1"}', DOCUMENT, b'{"do": "ping", "id": "2"}')
    held = Conversation(wire).hold()
    assert [json.loads(item)["id"] for item in wire.sent] == ["1", "2"]
    assert [item.text for item in held.registry.session.performed] == [DOCUMENT]
    assert held.notices == 3
    assert wire.closed == [(CLOSE_NORMAL, "")]


def test_client_is_served_without_an_admission_callback() -> None:
    registry = Registry()
    registry.session.has_unfinished_blocks = lambda _: False
    client, wire = registry.join("a"), PlayedWire(DOCUMENT)
    asyncio.run(serve_client(registry, wire, client))
    assert len(registry.session.performed) == 1


def test_read_time_limit_of_a_connection_ends_when_the_client_is_admitted() -> None:
    wire = PlayedWire(b'{"do": "hello", "token": "open sesame"}', b'{"do": "ping"}')
    Conversation(wire, TOKEN_ACCESS).hold()
    assert wire.hurries == [True, False]


def test_client_that_closed_its_sending_side_still_gets_all_feedback_of_its_blocks() -> None:
    wire = PlayedWire(DOCUMENT)
    held = Conversation(wire, unfinished=2).hold()
    assert wire.sent == ["end of the block"]
    assert held.polls < 0


def test_connection_that_can_no_longer_receive_is_closed_at_once() -> None:
    wire = PlayedWire(DOCUMENT, lingers=False)
    assert Conversation(wire, unfinished=2).hold().polls == 2
    assert wire.sent == []
    assert wire.closed == [(CLOSE_NORMAL, "")]


def test_client_that_does_not_read_is_dropped_although_its_blocks_are_unfinished() -> None:
    wire = PlayedWire(b'{"do": "ping"}', stays_open=True)
    wire.refuses_output = True
    with pytest.raises(TimeoutError, match="does not read"):
        Conversation(wire, unfinished=10**9).hold()
    assert wire.closed == []


def test_client_registry_can_close_a_silent_connection() -> None:
    wire = PlayedWire(stays_open=True)
    held = Conversation(wire)

    async def run() -> None:
        talking = asyncio.create_task(serve_client(held.registry, wire, held.client))
        await asyncio.sleep(0.01)
        held.registry.close(1001, "the server ends")
        async with asyncio.timeout(PATIENCE):
            await talking

    asyncio.run(run())
    assert wire.closed == [(1001, "the server ends")]


def test_client_that_was_refused_is_not_read_any_more() -> None:
    wire = PlayedWire(b'{"do": "ping"}', DOCUMENT, stays_open=True)
    held = Conversation(wire, TOKEN_ACCESS).hold()
    assert len(wire.hurries) == 1
    ((code, why),) = wire.closed
    assert code == CLOSE_POLICY_VIOLATION
    assert "a token is needed" in why
    assert not held.registry.session.performed


def test_overlong_message_is_reported_and_closes_the_connection() -> None:
    wire = PlayedWire(DOCUMENT, fault=ValueError("at most 10 bytes"))
    held = Conversation(wire).hold()
    assert "rule message: at most 10 bytes" in wire.sent[-1]
    assert wire.closed == [(CLOSE_TOO_BIG, "at most 10 bytes")]
    assert not held.client.open


def test_incomplete_message_is_reported_and_not_performed() -> None:
    wire = PlayedWire(fault=HalfError("the connection ended"))
    held = Conversation(wire).hold()
    assert "rule half: the connection ended before the message did" in wire.sent[-1]
    assert wire.closed == [(CLOSE_POLICY_VIOLATION, "half a message")]
    assert not held.registry.session.performed


def test_client_that_becomes_a_stop_connection_is_no_longer_read_but_stays_connected() -> None:
    wire = PlayedWire(b'{"do": "stop_line"}', b'{"do": "stop"}', stays_open=True)
    held = Conversation(wire, unfinished=10**9).hold()
    assert held.client.stops_only
    assert wire.closed == []
    assert len(wire.hurries) == 1
    assert held.notices == 1
    assert not wire.is_reading


def test_messages_of_two_busy_clients_are_processed_alternately() -> None:
    order: list[str] = []

    async def run() -> None:
        held = [Conversation(PlayedWire(*[b'{"do": "ping"}'] * 5)) for _ in range(2)]
        talks = [
            serve_client(each.registry, each.wire, each.client, notice=lambda k=k: order.append(k))
            for k, each in enumerate(held)
        ]
        await asyncio.gather(*talks)

    asyncio.run(run())
    assert order == [0, 1] * 5
