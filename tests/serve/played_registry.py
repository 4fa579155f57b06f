"""Client registry with a stub session."""

import asyncio
import json
from collections.abc import Callable

from kinesic.realizer.request import Message
from kinesic.serve.clients import ClientRegistry, ConnectedClient
from kinesic.serve.messages import Restyling
from kinesic.serve.wire.origin import OPEN_ACCESS, Access
from kinesic.serve.wire.quotas import Quotas

TEST_QUOTAS = Quotas(rate=10.0, burst=4, clients=2)


class Performer:
    """Stub session that records its calls."""

    def __init__(self) -> None:
        self.done: list[tuple] = []
        self.performed: list[Message] = []
        self.refusal: str | None = None
        self.obstacle = ""
        self.fault: Exception | None = None
        self.desk = self.arming = self.loop = self

    def perform(self, document: Message) -> str | None:
        self.performed.append(document)
        return self.refusal

    def emergency_stop(self) -> None:
        if self.fault is not None:
            raise self.fault
        self.done.append(("halt",))

    def resume(self) -> None:
        self.done.append(("resume",))

    def interrupt(self, block: str | None, *, yields: bool = False, sender: int | None = None) -> None:
        self.done.append(("interrupt", block, *(["yields"] * yields)))

    def change_sound(self, change: Callable[[object], None]) -> None:
        change(self)

    def duck(self, *, on: bool) -> None:
        self.done.append(("duck", on))

    def restyle(self, restyling: Restyling) -> None:
        self.done.append(("restyle", restyling))

    def converse(self, message: object, sender: int) -> str:
        self.done.append(("converse", message, sender))
        return self.obstacle

    def status(self) -> dict[str, object]:
        return {"state": "resting"}

    def arm(self, client: ConnectedClient, request: object, *, trusted: bool) -> None:
        self.done.append(("arm", client.number, trusted))

    def disarm(self, client: ConnectedClient, request: object) -> None:
        self.done.append(("disarm", client.number))

    def answer(self, requester: object, question: object) -> None:
        self.requester = requester
        self.done.append(("answer", requester.number, question))


class Registry(ClientRegistry):
    """Client registry with a stub session."""

    session: Performer

    def __init__(self, access: Access = OPEN_ACCESS, rules: Quotas = TEST_QUOTAS) -> None:
        super().__init__(rules, access, lambda _: Performer())

    def say(self, client: ConnectedClient, message: bytes | dict) -> list[str]:
        """Return the messages to a client after its message."""
        self.receive(client, json.dumps(message).encode() if isinstance(message, dict) else message)
        return told(client)


def told(client: ConnectedClient) -> list[str]:
    async def take() -> list[str]:
        return [await client.output.take() or "" for _ in range(len(client.output))]

    return asyncio.run(take())


TOKEN_ACCESS = Access("open sesame")
