"""A client is attended to by two tasks: one receives from it and the other sends to it, until it goes or is closed."""

from asyncio import FIRST_COMPLETED, create_task, gather, sleep, wait
from collections.abc import AsyncIterator, Callable
from typing import Protocol

from kinesic.serve.clients import POLICY, TOO_BIG, ClientRegistry, ConnectedClient
from kinesic.serve.wire.quotas import quota_feedback
from kinesic.serve.wire.transport import HalfError

LOOK = 0.05  # [s] between two looks at whether a client is owed something


class ClientWire(Protocol):
    """Messages to and from a client, by any transport."""

    lingers: bool  # whether a client that says nothing more may still listen

    def messages(self, hurry: Callable[[], bool], /) -> AsyncIterator[bytes]:
        """Messages of the client as they come."""

    async def send(self, message: str, /) -> None:
        """Sends the client a message."""

    async def close(self, code: int, why: str, /) -> None:
        """Closes the connection, and says why."""


async def attend(
    clients: ClientRegistry, wire: ClientWire, client: ConnectedClient, *, notice: Callable[[], None] = lambda: None
) -> None:
    """Receives from a client and sends to it until it goes, is closed, or only stops the robot from now on.

    Args:
        clients: take its messages.
        wire: to the client.
        client: that has joined; it leaves at the end.
        notice: called after each message.

    Raises:
        OSError: it has gone, or does not read.
    """
    receiving = create_task(_receive(clients, wire, client, notice))
    sending = create_task(_send(wire, client))
    try:
        await wait((receiving, sending), return_when=FIRST_COMPLETED)
        while wire.lingers and not client.stops_only and not sending.done() and clients.session.owes(client.number):
            await sleep(LOOK)
        client.output.end()
        receiving.cancel()
        await gather(receiving, return_exceptions=True)  # nobody else reads when the connection is closed
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
            await sleep(0)  # others have their turn, however many messages came at once
    except StopAsyncIteration:
        return
    except ValueError as error:
        clients.refuse_overlong(client, error)
        client.close(TOO_BIG, str(error))
    except HalfError as error:
        client.send(quota_feedback("half", f"{error} before the message did; it is not performed"))
        client.close(POLICY, "half a message")


async def _send(wire: ClientWire, client: ConnectedClient) -> None:
    while (message := await client.output.take()) is not None:
        await wire.send(message)
