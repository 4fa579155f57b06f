"""Registers clients, whatever transport they came by, obeys their control messages and hands on their documents."""

from collections.abc import Callable
from dataclasses import dataclass
from hmac import compare_digest
from itertools import count

from kinesic.bml.block import NoticeType
from kinesic.realizer.request import Message
from kinesic.serve.desk.asker import Asker
from kinesic.serve.messages import Restyling, Words
from kinesic.serve.queues import OutputQueue, UnreadMemory
from kinesic.serve.session import Session
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.protocol import (
    Arm,
    Control,
    Disarm,
    Enquiry,
    Hello,
    InterruptCommand,
    Ping,
    Restyle,
    Resume,
    SpokenWords,
    Stop,
    StopLineRequest,
    control,
    is_text,
    json_answer,
    stop_failure,
)
from kinesic.serve.wire.questions import ReachQuestion
from kinesic.serve.wire.quotas import Quotas, TokenBucket, quota_feedback

NORMAL, POLICY, TOO_BIG, LATER = 1000, 1008, 1009, 1013  # WebSocket's close codes
EXCESS = 10  # times as many messages as are taken at once may be refused before a client is sent away
MANY = ReachQuestion | SpokenWords  # messages of which there are many
DRAGGED = 4  # times as many of these are taken as of others
NO_TOKEN = 'a token is needed: send {"do": "hello", "token": "..."} first'


@dataclass(eq=False)
class ConnectedClient:
    """A client as the server knows it."""

    number: int
    name: str  # its address
    admitted: bool  # has shown the token, or needs none
    bucket: TokenBucket  # of messages that are taken
    questions: TokenBucket  # of those that ask for a reach, while somebody drags a hand, and of words
    excess: TokenBucket  # of those that are refused one by one
    output: OutputQueue
    movable: bool  # a connection that another thread may go on with; standard input is none
    placed: bool = False  # has one of the places; without one it may only stop
    stops_only: bool = False  # wants a connection past all others, for nothing but stops
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
        self._taken = 0  # places
        self._unread = UnreadMemory(rules.unread_bytes_of_all)
        self._numbers = count(1)
        self.session = session(self)

    def join(self, name: str, *, trusted: bool = False, movable: bool = True) -> ConnectedClient:
        """Takes up a client.

        Args:
            name: its address.
            trusted: needs no token, because it has shown it or is no stranger.
            movable: whether its connection may become one that only stops.
        """
        rate, burst = self.rules.rate, self.rules.burst
        client = ConnectedClient(
            number=next(self._numbers),
            name=name,
            admitted=trusted or self.access.token is None,
            bucket=TokenBucket(rate, burst),
            questions=TokenBucket(DRAGGED * rate, DRAGGED * burst),
            excess=TokenBucket(rate, EXCESS * burst),
            output=OutputQueue(self.rules.unread, self.rules.unread_bytes, self._unread),
            movable=movable,
        )
        self._clients[client.number] = client
        return client

    def place(self, client: ConnectedClient) -> bool:
        """Gives a client that is admitted one of the places; False where none is left."""
        if not client.placed and client.admitted and self._taken < self.rules.clients:
            client.placed = True
            self._taken += 1
        return client.placed

    def leave(self, client: ConnectedClient) -> None:
        """Forgets a client that is gone; its blocks are performed all the same."""
        if self._clients.pop(client.number, None) is not None:
            self._taken -= client.placed
        client.output.discard()

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
            self._refuse(client, json_answer("refused", why=str(error)))
            return
        if not client.admitted:
            self._admit(client, request)
        elif isinstance(request, Stop):
            client.send(self._stop())
        elif isinstance(request, StopLineRequest):
            self._free(client)
        elif not self.place(client) and not isinstance(request, Hello):
            client.close(LATER, f"rule clients: {self.rules.clients} are connected already; you may only stop")
        elif not (client.questions if isinstance(request, MANY) else client.bucket).take():
            what = f"at most {self.rules.rate:g} messages a second are taken from each client"
            self._refuse(client, quota_feedback("rate", what))
        elif request is not None:
            self._obey(client, request)
        elif self.access.texts and is_text(message):
            self._hand_on(client, Words(message.decode(errors="replace"), client.number, ends=True))
        else:
            client.count += 1
            source = f"<{client.name}, message {client.count}>"  # no file, so that it names none beside it
            self._hand_on(client, Message(message, client.number, source))

    def _hand_on(self, client: ConnectedClient, message: Message) -> None:
        refusal = self.session.perform(message)
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

    def _is_here(self, client: ConnectedClient) -> bool:
        return client.open and client.number in self._clients

    def _free(self, client: ConnectedClient) -> None:
        """Lets a connection become one that only stops; standard input cannot."""
        client.stops_only = client.movable
        if not client.movable:
            self._refuse(client, json_answer("refused", why="standard input takes documents, too; send stop here"))

    def _refuse(self, client: ConnectedClient, why: str) -> None:
        """Refuses one message; who goes on and on is sent away."""
        client.send(why)
        if not client.excess.take():
            client.close(POLICY, "rule rate: too many messages were refused")

    def _admit(self, client: ConnectedClient, request: Control | None) -> None:
        if isinstance(request, Hello) and self.is_token(request.token):
            client.admitted = True
            self.place(client)
            client.send(json_answer("welcome"))
            return
        why = "the token is wrong" if isinstance(request, Hello) else NO_TOKEN
        client.send(json_answer("refused", why=why))
        client.close(POLICY, why)

    def _stop(self) -> str:
        """Makes an emergency stop; says whether it was made."""
        try:
            self.session.halt()
        except RuntimeError as error:
            return stop_failure(error)
        return json_answer("stopped")

    def _obey(self, client: ConnectedClient, request: Control) -> None:
        match request:
            case Resume():
                self.session.resume()
            case InterruptCommand(block):
                self.session.interrupt(block)
            case Restyle(style, changes, amount, block):
                self.session.restyle(Restyling(style, changes, amount, block, client.number))
            case SpokenWords(text, ends, instead):
                self._hand_on(client, Words(text, client.number, ends=ends, instead=instead))
            case Arm(token):
                trusted = self.access.token is None or self.is_token(token)
                self.session.arming.arm(client, request, trusted=trusted)
            case Disarm():
                self.session.arming.disarm(client, request)
            case Enquiry(id):
                number = {"id": id} if id else {}
                client.send(json_answer("status", **number, clients=self._taken, **self.session.status()))
            case Ping(id):
                client.send(json_answer("pong", id=id))
            case Hello() | StopLineRequest():
                client.send(json_answer("welcome"))
            case Stop():
                client.send(self._stop())
            case _:
                self.session.desk.answer(Asker(client.number, client.send, lambda: self._is_here(client)), request)
