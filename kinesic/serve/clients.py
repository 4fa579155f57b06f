"""Connected clients, their control messages and their documents."""

from collections.abc import Callable
from dataclasses import dataclass
from hmac import compare_digest
from itertools import count

from kinesic.bml.block import NoticeType
from kinesic.realizer.request import Message
from kinesic.serve.desk.requester import Requester
from kinesic.serve.messages import Restyling, Words
from kinesic.serve.queues import OutputQueue, UnreadMemory
from kinesic.serve.session import Session
from kinesic.serve.wire.conversing import (
    ConversationMessage,
    ConverseRequest,
    HeardReport,
    PeopleReport,
    PlayedReport,
    SoundPart,
    ThinkRequest,
    TurnReport,
)
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.protocol import (
    Arm,
    Control,
    Disarm,
    DuckRequest,
    Enquiry,
    Hello,
    InterruptCommand,
    Ping,
    Restyle,
    Resume,
    SpokenWords,
    Stop,
    StopLineRequest,
    is_text,
    json_answer,
    read_control,
    stop_failure,
)
from kinesic.serve.wire.questions import ReachQuestion
from kinesic.serve.wire.quotas import Quotas, TokenBucket, quota_feedback

CLOSE_NORMAL = 1000  # WebSocket close code of a normal end
CLOSE_POLICY_VIOLATION = 1008  # WebSocket close code of a policy violation
CLOSE_TOO_BIG = 1009  # WebSocket close code: a message exceeds the size limit
CLOSE_TRY_LATER = 1013  # WebSocket close code: the server is full
REFUSAL_BURST_FACTOR = 10  # refused messages, in multiples of `Quotas.burst`, before a client is disconnected
FREQUENT_MESSAGES = ReachQuestion | SpokenWords | ConversationMessage  # message types that clients send at high rates
FREQUENT_RATE_FACTOR = 4  # rate and burst limit of `FREQUENT_MESSAGES` relative to those of other messages
TOKEN_REQUIRED = 'a token is needed: send {"do": "hello", "token": "..."} first'  # reason of refusals before the token


@dataclass(eq=False)
class ConnectedClient:
    """Connected client with its rate limits, output queue and access rights."""

    number: int
    name: str  # network address
    admitted: bool  # whether the client has shown the token or needs none
    bucket: TokenBucket  # rate limit of ordinary messages
    questions: TokenBucket  # rate limit of frequent messages: reach questions while dragging, and words
    excess: TokenBucket  # rate limit of refused messages
    output: OutputQueue
    movable: bool  # whether the connection can become a stop line; False for standard input
    placed: bool = False  # whether the client has one of `Quotas.clients` slots; without it, it may only stop the robot
    stops_only: bool = False  # whether the connection becomes an emergency-stop line
    code: int = CLOSE_NORMAL  # WebSocket close code of the connection's end
    why: str = ""
    count: int = 0  # number of documents received from the client

    @property
    def open(self) -> bool:
        """Whether messages of this client are still accepted."""
        return self.code == CLOSE_NORMAL

    def send(self, message: str) -> None:
        """Queue a message for the client."""
        self.output.put(message)

    def close(self, code: int, why: str) -> None:
        """Close the connection after the client has read all queued messages."""
        self.code, self.why = code, why
        self.output.end()


class ClientRegistry:
    """Registry of all clients of a server, for any transport."""

    def __init__(self, rules: Quotas, access: Access, session: Callable[["ClientRegistry"], Session]) -> None:
        """Create a registry without clients.

        Args:
            rules: limits for each client.
            access: token and allowed origins.
            session: creates the session, which sends its feedback through this registry.
        """
        self.rules, self.access = rules, access
        self._clients: dict[int, ConnectedClient] = {}
        self._taken = 0  # clients with a place
        self._unread = UnreadMemory(rules.unread_bytes_of_all)
        self._numbers = count(1)
        self.session = session(self)

    def join(self, name: str, *, trusted: bool = False, movable: bool = True) -> ConnectedClient:
        """Register a new client.

        Args:
            name: network address.
            trusted: whether the client needs no token, or has shown it already.
            movable: whether the connection can become a stop line.
        """
        rate, burst = self.rules.rate, self.rules.burst
        client = ConnectedClient(
            number=next(self._numbers),
            name=name,
            admitted=trusted or self.access.token is None,
            bucket=TokenBucket(rate, burst),
            questions=TokenBucket(FREQUENT_RATE_FACTOR * rate, FREQUENT_RATE_FACTOR * burst),
            excess=TokenBucket(rate, REFUSAL_BURST_FACTOR * burst),
            output=OutputQueue(self.rules.unread, self.rules.unread_bytes, self._unread),
            movable=movable,
        )
        self._clients[client.number] = client
        return client

    def place(self, client: ConnectedClient) -> bool:
        """Reserve one of `Quotas.clients` slots, and return whether the client has one.

        A client that is not admitted, or comes when all places are taken, has none.
        """
        if not client.placed and client.admitted and self._taken < self.rules.clients:
            client.placed = True
            self._taken += 1
        return client.placed

    def leave(self, client: ConnectedClient) -> None:
        """Remove a disconnected client.

        Its blocks are still performed.
        """
        if self._clients.pop(client.number, None) is not None:
            self._taken -= client.placed
        client.output.discard()

    def is_token(self, token: str | None) -> bool:
        """Return whether a text equals the server's token.

        False if the server has no token.
        """
        correct = self.access.token
        shown = (token or "").encode(errors="surrogateescape")  # a header may hold any bytes
        return correct is not None and compare_digest(shown, correct.encode())

    def receive(self, client: ConnectedClient, message: bytes) -> None:
        """Process a message from a client.

        An emergency stop bypasses quotas and places; all other messages are subject to them.
        """
        try:
            request = read_control(message)
        except ValueError as error:
            self._refuse(client, json_answer("refused", why=str(error)))
            return
        if not client.admitted:
            self._admit(client, request)
        elif isinstance(request, Stop):
            self._obey(client, request)
        elif isinstance(request, StopLineRequest):
            self._free(client)
        elif not self.place(client) and not isinstance(request, Hello):
            client.close(
                CLOSE_TRY_LATER, f"rule clients: {self.rules.clients} are connected already; you may only stop"
            )
        elif not (client.questions if isinstance(request, FREQUENT_MESSAGES) else client.bucket).take():
            what = f"at most {self.rules.rate:g} messages a second are taken from each client"
            self._refuse(client, quota_feedback("rate", what))
        elif request is not None:
            self._obey(client, request)
        elif self.access.texts and is_text(message):
            self._submit(client, Words(message.decode(errors="replace"), client.number, ends=True))
        else:
            client.count += 1
            # The name is not a file name, so that relative paths in the document do not resolve.
            source = f"<{client.name}, message {client.count}>"
            self._submit(client, Message(message, client.number, source))

    def _submit(self, client: ConnectedClient, message: Message) -> None:
        refusal = self.session.perform(message)
        if refusal is not None:
            client.send(refusal)

    def refuse_overlong(self, client: ConnectedClient, error: ValueError) -> None:
        """Warn a client that its message exceeds the size limit."""
        client.send(quota_feedback("message", str(error), type_=NoticeType.PARSING_FAILURE))

    def tell(self, message: str, sender: int) -> None:
        """Send a message to a client if the client is still connected."""
        client = self._clients.get(sender)
        if client is not None:
            client.send(message)

    def close(self, code: int, why: str) -> None:
        """Close all client connections once their queued messages are read."""
        for client in self._clients.values():
            client.close(code, why)

    def _is_here(self, client: ConnectedClient) -> bool:
        return client.open and client.number in self._clients

    def _free(self, client: ConnectedClient) -> None:
        """Turn a connection into an emergency-stop line, unless it is standard input."""
        client.stops_only = client.movable
        if not client.movable:
            self._refuse(client, json_answer("refused", why="standard input cannot become a stop line; send stop here"))

    def _refuse(self, client: ConnectedClient, why: str) -> None:
        """Refuse a message, and disconnect after too many refusals."""
        client.send(why)
        if not client.excess.take():
            client.close(CLOSE_POLICY_VIOLATION, "rule rate: too many messages were refused")

    def _admit(self, client: ConnectedClient, request: Control | None) -> None:
        if isinstance(request, Hello) and self.is_token(request.token):
            client.admitted = True
            self.place(client)
            client.send(json_answer("welcome"))
            return
        why = "the token is wrong" if isinstance(request, Hello) else TOKEN_REQUIRED
        client.send(json_answer("refused", why=why))
        client.close(CLOSE_POLICY_VIOLATION, why)

    def _stop(self) -> str:
        """Request an emergency stop and return the answer for the client."""
        try:
            self.session.emergency_stop()
        except RuntimeError as error:
            return stop_failure(error)
        return json_answer("stopped")

    def _obey(self, client: ConnectedClient, request: Control) -> None:
        match request:
            case Resume():
                self.session.resume()
            case DuckRequest(on):
                self.session.loop.change_sound(lambda effects: effects.duck(on=on))
            case InterruptCommand(block, yields):
                self.session.interrupt(block, yields=yields, sender=client.number)
            case Restyle(style, changes, amount, block):
                self.session.restyle(Restyling(style, changes, amount, block, client.number))
            case SpokenWords(text, ends, instead, style):
                self._submit(client, Words(text, client.number, ends=ends, instead=instead, style=style))
            case ConverseRequest():
                obstacle = self.session.converse(request, client.number)
                if obstacle:
                    client.send(json_answer("refused", do="converse", why=obstacle))
            case PeopleReport() | HeardReport() | TurnReport() | ThinkRequest() | SoundPart() | PlayedReport():
                self.session.converse(request, client.number)
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
                self.session.desk.answer(Requester(client.number, client.send, lambda: self._is_here(client)), request)
