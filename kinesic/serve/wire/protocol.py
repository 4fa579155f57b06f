"""Message framing and control messages of clients.

A message is UTF-8 text that ends with a NUL byte, which neither XML nor JSON contains; on a WebSocket it is one
WebSocket message. Text that begins with `{` and has a key `do` is a control message. Anything else is a document, or
plain text where that is allowed.
"""

import msgspec
from msgspec import Struct

from kinesic.bml.reading.wrapping import find_root, is_wrapped
from kinesic.serve.wire.conversing import CONVERSATION_VERBS, ConversationMessage
from kinesic.serve.wire.questions import LONG_VERBS, Question

MESSAGE_END = b"\0"  # byte that terminates a message in a byte stream
MAX_CONTROL_SIZE = 4096  # [bytes] largest control message without a document
BLANK_BYTES = b" \t\r\n\xef\xbb\xbf"  # whitespace bytes around a message, with the UTF-8 byte order mark


class MessageFramer:
    """Splitter of a byte stream into messages."""

    def __init__(self, max_size: int) -> None:
        """Create an empty splitter for messages up to a size in bytes."""
        self._max_size = max_size
        self._rest = bytearray()

    @property
    def is_midway(self) -> bool:
        """Whether a message is incomplete."""
        return bool(self._rest)

    def feed(self, data: bytes) -> list[bytes]:
        """Add bytes and return the completed messages, without empty ones.

        Raises:
            ValueError: a message exceeds the size limit.
        """
        *ends, rest = data.split(MESSAGE_END)
        messages = []
        for end in ends:
            self._add(end)
            if self._rest:
                messages.append(bytes(self._rest))
            self._rest.clear()
        self._add(rest)
        return messages

    def _add(self, piece: bytes) -> None:
        self._rest += piece if self._rest else piece.lstrip(BLANK_BYTES)
        if len(self._rest) > self._max_size:
            raise ValueError(
                f"a message has {len(self._rest)} bytes or more, at most {self._max_size} are read: split it"
            )


class Hello(Struct, tag="hello", tag_field="do", forbid_unknown_fields=True):
    """First message of a client if a token is required."""

    token: str  # token of `--token-file` or `KINESIC_TOKEN`


class Stop(Struct, tag="stop", tag_field="do", forbid_unknown_fields=True):
    """Emergency stop: decelerate in minimum time and refuse blocks until `resume`."""


class StopLineRequest(Struct, tag="stop_line", tag_field="do", forbid_unknown_fields=True):
    """Request to turn this connection into an emergency-stop line."""


class Resume(Struct, tag="resume", tag_field="do", forbid_unknown_fields=True):
    """Request to return to rest after a stop and accept blocks again."""


class DuckRequest(Struct, tag="duck", tag_field="do", forbid_unknown_fields=True):
    """Request to mute speech while a person speaks, or to unmute it."""

    on: bool  # whether to mute, for at most 5 s; the motion goes on, and muted words are lost


class InterruptCommand(Struct, tag="interrupt", tag_field="do", forbid_unknown_fields=True, rename={"yields": "yield"}):
    """Request to end one block or all blocks with smooth motion.

    Speech fades out within 40 ms.
    """

    block: str | None = None  # id of the block; if missing, all blocks are meant
    yields: bool = False  # whether the robot yields to a person: arms hold first, and `yielded` contains the heard text


class Restyle(Struct, tag="style", tag_field="do", forbid_unknown_fields=True):
    """Request to change the style of one block or all blocks."""

    style: str | None = None  # name of a style
    set: tuple[str, ...] = ()  # changes of the style, each as NAME=VALUE
    amount: float | None = None  # amount of movement, 0..1; None: unchanged
    block: str | None = None  # id of the only block to change


class SpokenWords(Struct, tag="words", tag_field="do", forbid_unknown_fields=True):
    """Streamed text that is spoken phrase by phrase with fitting gestures."""

    text: str = ""  # next piece of the text, with its spaces
    ends: bool = False  # whether the text is complete
    instead: bool = False  # whether this text replaces all unspoken words
    style: str = ""  # name of the style of this text; empty: the server's style


class Arm(Struct, tag="arm", tag_field="do", forbid_unknown_fields=True):
    """Request to enable the servo torque.

    With `code`, a person has confirmed that the robot's workspace is clear.
    """

    token: str | None = None  # token, if the server requires one
    code: str | None = None  # confirmation code from the server
    id: int = 0  # number that the answer repeats; 0: none


class Disarm(Struct, tag="disarm", tag_field="do", forbid_unknown_fields=True):
    """Request to end all blocks, fold to rest and disable all torque."""

    id: int = 0  # number that the answer repeats; 0: none


class Enquiry(Struct, tag="status", tag_field="do", forbid_unknown_fields=True):
    """Request for the server status."""

    id: int = 0  # number that the answer repeats; 0: none


class Ping(Struct, tag="ping", tag_field="do", forbid_unknown_fields=True):
    """Request for a `pong` answer, which tests the connection."""

    id: str = ""  # repeated in the answer


Torque = Arm | Disarm
Control = (
    Hello
    | Stop
    | StopLineRequest
    | Resume
    | DuckRequest
    | InterruptCommand
    | Restyle
    | SpokenWords
    | Torque
    | Enquiry
    | Ping
    | ConversationMessage
    | Question
)


class _Verb(Struct):
    do: str


_controls = msgspec.json.Decoder(Control)
_verbs = msgspec.json.Decoder(_Verb)


def read_control(message: bytes) -> Control | None:
    """Decode a control message, or return None for a document.

    Raises:
        ValueError: the control message is invalid; the text names valid values.
    """
    text = message.strip(BLANK_BYTES)
    if not text.startswith(b"{"):
        return None
    try:
        verb = _verbs.decode(text).do
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):  # the reader of documents names the place
        return None
    if len(text) > MAX_CONTROL_SIZE and verb not in LONG_VERBS | CONVERSATION_VERBS:
        return None
    try:
        request: Control = _controls.decode(text)
    except (msgspec.ValidationError, RecursionError) as error:
        raise ValueError(f"{error}; see docs/reference/wire-protocol.md for the control messages") from None
    return request


def is_text(message: bytes) -> bool:
    """Return whether a message is text or SSML, not BML or JSON."""
    if message.lstrip(BLANK_BYTES).startswith((b"<", b"{", b"[")):
        return find_root(message) == "speak"
    return not is_wrapped(message) or find_root(message) == "speak"


def stop_failure(error: Exception) -> str:
    """Encode the answer to a stop that may have failed."""
    return json_answer("failed", why=f"the robot may not stop ({error}): use the switch that cuts the power")


def json_answer(kind: str, **values: object) -> str:
    """Encode a non-BML answer as JSON."""
    return msgspec.json.encode({"told": kind} | values).decode()
