"""Concurrent receive and send tasks of one client."""

from asyncio import FIRST_COMPLETED, create_task, gather, sleep, wait
from collections.abc import AsyncIterator, Callable
from typing import Protocol

from kinesic.serve.clients import CLOSE_POLICY_VIOLATION, CLOSE_TOO_BIG, ClientRegistry, ConnectedClient
from kinesic.serve.wire.quotas import quota_feedback
from kinesic.serve.wire.transport import HalfError

UNFINISHED_POLL_PERIOD = 0.05  # [s] between checks for unfinished blocks after a client stops sending


class ClientWire(Protocol):
    """Message connection to a client over any transport."""

    lingers: bool  # whether a client that has closed its sending side may still receive

    def messages(self, hurry: Callable[[], bool], /) -> AsyncIterator[bytes]:
        """Yield messages from the client as they arrive."""

    async def send(self, message: str, /) -> None:
        """Send a message to the client."""

    async def close(self, code: int, why: str, /) -> None:
        """Close the connection and report the reason to the client."""


async def serve_client(
    clients: ClientRegistry, wire: ClientWire, client: ConnectedClient, *, notice: Callable[[], None] = lambda: None
) -> None:
    """Serve a client until it disconnects or becomes an emergency-stop line.

    Args:
        clients: registry that processes the messages.
        wire: connection to the client.
        client: registered client; it is removed at the end.
        notice: called after each message.

    Raises:
        OSError: the client has disconnected or does not read.
    """
    receiving = create_task(_receive(clients, wire, client, notice))
    sending = create_task(_send(wire, client))
    try:
        await wait((receiving, sending), return_when=FIRST_COMPLETED)
        while (
            wire.lingers
            and not client.stops_only
            and not sending.done()
            and clients.session.has_unfinished_blocks(client.number)
        ):
            await sleep(UNFINISHED_POLL_PERIOD)
        client.output.end()
        receiving.cancel()
        await gather(receiving, return_exceptions=True)  # the connection is closed without a concurrent reader
        await sending
        if not client.stops_only:
            await wire.close(client.code, client.why)
    finally:
        clients.leave(client)
        for task in (receiving, sending):
            task.cancel()
        await gather(receiving, sending, return_exceptions=True)


async def _receive(
    clients: ClientRegistry, wire: ClientWire, client: ConnectedClient, notice: Callable[[], None]
) -> None:
    try:
        messages = wire.messages(lambda: not client.admitted)
        while client.open:
            clients.receive(client, await anext(messages))
            notice()
            if client.stops_only:
                return
            await sleep(0)  # other clients take turns, even with many buffered messages
    except StopAsyncIteration:
        return
    except ValueError as error:
        clients.refuse_overlong(client, error)
        client.close(CLOSE_TOO_BIG, str(error))
    except HalfError as error:
        client.send(quota_feedback("half", f"{error} before the message did; it is not performed"))
        client.close(CLOSE_POLICY_VIOLATION, "half a message")


async def _send(wire: ClientWire, client: ConnectedClient) -> None:
    while (message := await client.output.take()) is not None:
        await wire.send(message)
