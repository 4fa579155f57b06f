"""The clients, whatever wire they came by: control messages are obeyed, documents are handed on."""

from collections.abc import Callable
from dataclasses import dataclass
from hmac import compare_digest
from itertools import count

from kinesic.bml.block import NoticeType
from kinesic.serve.messages import Restyling
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
from kinesic.serve.queues import OutputQueue, QueuedDocument
from kinesic.serve.quotas import Quotas, TokenBucket, quota_feedback
from kinesic.serve.session import Session

NORMAL, POLICY, TOO_BIG, LATER = 1000, 1008, 1009, 1013  # WebSocket's close codes
NO_TOKEN = 'a token is needed: send {"do": "hello", "token": "..."} first'


@dataclass(eq=False)
class ConnectedClient:
    """What the server knows of a client."""

    number: int
    name: str  # where it is
    admitted: bool  # has shown the token, or needs none
    bucket: TokenBucket
    outbox: OutputQueue
    code: int = NORMAL  # why it was closed, as WebSocket says it
    why: str = ""
    count: int = 0  # documents so far

    @property
    def open(self) -> bool:
        """Whether it is still listened to."""
        return self.code == NORMAL

    def put(self, message: str) -> None:
        """Sends a message, when it is this message's turn."""
        self.outbox.put(message)

    def close(self, code: int, why: str) -> None:
        """Ends the connection after what is still to be read."""
        self.code, self.why = code, why
        self.outbox.end()


class ClientRegistry:
    """All clients of a server."""

    def __init__(self, rules: Quotas, token: str | None, performer: Callable[["ClientRegistry"], Session]) -> None:
        """With nobody there.

        Args:
            rules: what a client may do.
            token: that each client must show; None: none is needed.
            performer: made for this desk, whose `tell` it uses.
        """
        self.rules, self._token = rules, token
        self._guests: dict[int, ConnectedClient] = {}
        self._numbers = count(1)
        self.performer = performer(self)

    def joined(self, name: str, *, token: str | None = None, trusted: bool = False) -> ConnectedClient:
        """Somebody has come.

        Args:
            name: where it is.
            token: that came with the connection.
            trusted: needs no token.
        """
        admitted = trusted or self._token is None or self.is_right(token)
        guest = ConnectedClient(
            next(self._numbers), name, admitted, TokenBucket(self.rules), OutputQueue(self.rules.unread)
        )
        if len(self._guests) >= self.rules.clients:
            guest.close(LATER, f"rule clients: {self.rules.clients} are connected already")
        elif token is not None and not admitted:
            guest.close(POLICY, "the token is wrong")
        else:
            self._guests[guest.number] = guest
        return guest

    def left(self, guest: ConnectedClient) -> None:
        """Somebody is gone; its blocks are performed all the same."""
        self._guests.pop(guest.number, None)
        guest.outbox.end()

    @property
    def is_open(self) -> bool:
        """Whether no token is needed."""
        return self._token is None

    def is_right(self, token: str | None) -> bool:
        """Whether this is the token."""
        return token is not None and self._token is not None and compare_digest(token.encode(), self._token.encode())

    def heard(self, guest: ConnectedClient, message: bytes) -> None:
        """Takes a message: an emergency stop before all that waits, everything else within the rules."""
        try:
            wish = control(message)
        except ValueError as error:
            guest.put(json_answer("refused", why=str(error)))
            return
        if not guest.admitted:
            self._admit(guest, wish)
        elif isinstance(wish, Stop):
            self.performer.halt()
            guest.put(json_answer("stopped"))
        elif not guest.bucket.takes():
            guest.put(
                quota_feedback("rate", f"at most {self.rules.rate:g} messages a second are taken from each client")
            )
        elif wish is not None:
            self._obey(guest, wish)
        else:
            guest.count += 1
            source = f"{guest.name}, message {guest.count}"
            refusal = self.performer.perform(QueuedDocument(message, guest.number, source))
            if refusal is not None:
                guest.put(refusal)

    def overlong(self, guest: ConnectedClient, error: ValueError) -> None:
        """A message was longer than it may be."""
        guest.put(quota_feedback("message", str(error), type_=NoticeType.PARSING_FAILURE))

    def tell(self, message: str, sender: int) -> None:
        """Gives a sender a message, if it is still there."""
        guest = self._guests.get(sender)
        if guest is not None:
            guest.put(message)

    def close(self, code: int, why: str) -> None:
        """Sends everybody home."""
        for guest in self._guests.values():
            guest.close(code, why)

    def _admit(self, guest: ConnectedClient, wish: Control | None) -> None:
        if isinstance(wish, Hello) and self.is_right(wish.token):
            guest.admitted = True
            guest.put(json_answer("welcome"))
            return
        why = "the token is wrong" if isinstance(wish, Hello) else NO_TOKEN
        guest.put(json_answer("refused", why=why))
        guest.close(POLICY, why)

    def _obey(self, guest: ConnectedClient, wish: Control) -> None:
        match wish:
            case Resume():
                self.performer.resume()
            case InterruptCommand(block):
                self.performer.interrupt(block)
            case Restyle(style, changes, amount, block):
                self.performer.restyle(Restyling(style, changes, amount, block, guest.number))
            case Enquiry():
                guest.put(json_answer("status", clients=len(self._guests), **self.performer.status()))
            case Ping(id):
                guest.put(json_answer("pong", id=id))
            case Hello():
                guest.put(json_answer("welcome"))
            case Stop():
                self.performer.halt()
