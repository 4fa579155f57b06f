"""Registers clients, whatever transport they came by, obeys their control messages and hands on their documents."""

from collections.abc import Callable
from dataclasses import dataclass
from hmac import compare_digest
from itertools import count

from kinesic.bml.block import NoticeType
from kinesic.realizer.request import Message
from kinesic.serve.messages import Restyling
from kinesic.serve.origin import Access
from kinesic.serve.protocol import (
    Control,
    Enquiry,
    Hello,
    InterruptCommand,
    Ping,
    Restyle,
    Resume,
    Stop,
    control,
    json_answer,
)
from kinesic.serve.queues import OutputQueue
from kinesic.serve.quotas import Quotas, TokenBucket, quota_feedback
from kinesic.serve.session import Session

NORMAL, POLICY, TOO_BIG, LATER = 1000, 1008, 1009, 1013  # WebSocket's close codes
NO_TOKEN = 'a token is needed: send {"do": "hello", "token": "..."} first'


@dataclass(eq=False)
class ConnectedClient:
    """A client as the server knows it."""

    number: int
    name: str  # its address
    admitted: bool  # has shown the token, or needs none
    bucket: TokenBucket
    output: OutputQueue
    code: int = NORMAL  # why it was closed, as WebSocket says it
    why: str = ""
    count: int = 0  # documents so far

    @property
    def open(self) -> bool:
        """Whether its messages are still taken."""
        return self.code == NORMAL

    def send(self, message: str) -> None:
        """Queues a message to it."""
        self.output.put(message)

    def close(self, code: int, why: str) -> None:
        """Closes the connection once the client has read what is queued."""
        self.code, self.why = code, why
        self.output.end()


class ClientRegistry:
    """All clients of a server."""

    def __init__(self, rules: Quotas, access: Access, session: Callable[["ClientRegistry"], Session]) -> None:
        """Begins without clients.

        Args:
            rules: what a client may do.
            access: who may connect.
            session: makes one that sends through this registry.
        """
        self.rules, self.access = rules, access
        self._clients: dict[int, ConnectedClient] = {}
        self._numbers = count(1)
        self.session = session(self)

    def join(self, name: str, *, token: str | None = None, trusted: bool = False) -> ConnectedClient:
        """Takes up a client; one that is not let in is closed already.

        Args:
            name: its address.
            token: that came with the connection.
            trusted: needs no token.
        """
        admitted = trusted or self.access.token is None or self.is_token(token)
        client = ConnectedClient(
            next(self._numbers), name, admitted, TokenBucket(self.rules), OutputQueue(self.rules.unread)
        )
        if len(self._clients) >= self.rules.clients:
            client.close(LATER, f"rule clients: {self.rules.clients} are connected already")
        elif token is not None and not admitted:
            client.close(POLICY, "the token is wrong")
        else:
            self._clients[client.number] = client
        return client

    def leave(self, client: ConnectedClient) -> None:
        """Forgets a client that is gone; its blocks are performed all the same."""
        self._clients.pop(client.number, None)
        client.output.end()

    def is_token(self, token: str | None) -> bool:
        """Whether a client's token is right."""
        right = self.access.token
        shown = (token or "").encode(errors="surrogateescape")  # a header may hold any bytes
        return right is not None and compare_digest(shown, right.encode())

    def receive(self, client: ConnectedClient, message: bytes) -> None:
        """Takes a message: an emergency stop before all that waits, everything else within the rules."""
        try:
            request = control(message)
        except ValueError as error:
            client.send(json_answer("refused", why=str(error)))
            return
        if not client.admitted:
            self._admit(client, request)
        elif isinstance(request, Stop):
            self.session.halt()
            client.send(json_answer("stopped"))
        elif not client.bucket.take():
            client.send(
                quota_feedback("rate", f"at most {self.rules.rate:g} messages a second are taken from each client")
            )
        elif request is not None:
            self._obey(client, request)
        else:
            client.count += 1
            source = f"{client.name}, message {client.count}"
            refusal = self.session.perform(Message(message, client.number, source))
            if refusal is not None:
                client.send(refusal)

    def refuse_overlong(self, client: ConnectedClient, error: ValueError) -> None:
        """Answers a message that is longer than it may be."""
        client.send(quota_feedback("message", str(error), type_=NoticeType.PARSING_FAILURE))

    def tell(self, message: str, sender: int) -> None:
        """Sends a message to a client, if it is still there."""
        client = self._clients.get(sender)
        if client is not None:
            client.send(message)

    def close(self, code: int, why: str) -> None:
        """Closes the connections of all clients."""
        for client in self._clients.values():
            client.close(code, why)

    def _admit(self, client: ConnectedClient, request: Control | None) -> None:
        if isinstance(request, Hello) and self.is_token(request.token):
            client.admitted = True
            client.send(json_answer("welcome"))
            return
        why = "the token is wrong" if isinstance(request, Hello) else NO_TOKEN
        client.send(json_answer("refused", why=why))
        client.close(POLICY, why)

    def _obey(self, client: ConnectedClient, request: Control) -> None:
        match request:
            case Resume():
                self.session.resume()
            case InterruptCommand(block):
                self.session.interrupt(block)
            case Restyle(style, changes, amount, block):
                self.session.restyle(Restyling(style, changes, amount, block, client.number))
            case Enquiry():
                client.send(json_answer("status", clients=len(self._clients), **self.session.status()))
            case Ping(id):
                client.send(json_answer("pong", id=id))
            case Hello():
                client.send(json_answer("welcome"))
            case Stop():
                self.session.halt()
