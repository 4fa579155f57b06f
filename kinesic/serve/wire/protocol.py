"""Messages as bytes: how they are told apart in a stream, and those that are not BML.

A message is UTF-8 text that ends with a NUL byte, which no XML and no JSON contains; on a WebSocket it is one message.
Text that begins with `{` and has a key `do` is a control message, anything else is a document, or a plain text where
these are allowed.
"""

import msgspec
from msgspec import Struct

from kinesic.serve.wire.questions import LONG_VERBS, Question

END = b"\0"
MOST_CONTROL = 4096  # [bytes] of a control message that carries no document
BLANK = b" \t\r\n\xef\xbb\xbf"  # may stand around a message


class MessageFramer:
    """Cuts a stream into messages, whatever pieces it comes in."""

    def __init__(self, most: int) -> None:
        """Begins within no message, for messages of so many bytes at most."""
        self._most = most
        self._rest = bytearray()

    @property
    def is_midway(self) -> bool:
        """Whether a message has begun and not ended."""
        return bool(self._rest)

    def feed(self, data: bytes) -> list[bytes]:
        """Takes bytes, and gives the messages that they complete, without those that are empty.

        Raises:
            ValueError: one is longer than it may be.
        """
        *ends, rest = data.split(END)
        whole = []
        for end in ends:
            self._add(end)
            if self._rest:
                whole.append(bytes(self._rest))
            self._rest.clear()
        self._add(rest)
        return whole

    def _add(self, piece: bytes) -> None:
        self._rest += piece if self._rest else piece.lstrip(BLANK)
        if len(self._rest) > self._most:
            raise ValueError(f"a message has {len(self._rest)} bytes or more, at most {self._most} are read: split it")


class Hello(Struct, tag="hello", tag_field="do", forbid_unknown_fields=True):
    """The first message where a token is asked for."""

    token: str


class Stop(Struct, tag="stop", tag_field="do", forbid_unknown_fields=True):
    """Emergency stop: comes to rest in the least time and takes no block until `resume`."""


class StopLineRequest(Struct, tag="stop_line", tag_field="do", forbid_unknown_fields=True):
    """Makes this connection one that only stops the robot, past all other clients."""


class Resume(Struct, tag="resume", tag_field="do", forbid_unknown_fields=True):
    """Back to rest after a stop; blocks are taken again."""


class InterruptCommand(Struct, tag="interrupt", tag_field="do", forbid_unknown_fields=True):
    """Ends a block, or all of them, softly."""

    block: str | None = None


class Restyle(Struct, tag="style", tag_field="do", forbid_unknown_fields=True):
    """Changes the style of what plays and what comes."""

    style: str | None = None  # name
    set: tuple[str, ...] = ()  # NAME=VALUE, as the command line's --set
    amount: float | None = None  # of movements, 0..1
    block: str | None = None  # of this block alone


class SpokenWords(Struct, tag="words", tag_field="do", forbid_unknown_fields=True):
    """Words that are said as their phrases are whole, with gestures that fit them."""

    text: str = ""
    ends: bool = False  # whether no more follow
    instead: bool = False  # whether they take the place of all that is not said yet


class Arm(Struct, tag="arm", tag_field="do", forbid_unknown_fields=True):
    """Asks to give servos their torque; with `code`, a person has confirmed that nobody is in the way."""

    token: str | None = None
    code: str | None = None  # that the server has told for this
    id: int = 0


class Disarm(Struct, tag="disarm", tag_field="do", forbid_unknown_fields=True):
    """Ends all blocks, folds to rest and takes the torque of all servos."""

    id: int = 0


class Enquiry(Struct, tag="status", tag_field="do", forbid_unknown_fields=True):
    """Asks for the status."""

    id: int = 0  # of the question, in its answer; 0: it has none


class Ping(Struct, tag="ping", tag_field="do", forbid_unknown_fields=True):
    """Asks for a sign of life."""

    id: str = ""


Torque = Arm | Disarm
Control = (
    Hello
    | Stop
    | StopLineRequest
    | Resume
    | InterruptCommand
    | Restyle
    | SpokenWords
    | Torque
    | Enquiry
    | Ping
    | Question
)


class _Verb(Struct):
    do: str


_controls = msgspec.json.Decoder(Control)
_verbs = msgspec.json.Decoder(_Verb)


def control(message: bytes) -> Control | None:
    """Reads a control message; None for a document.

    Raises:
        ValueError: it is one, and wrong; what would have worked.
    """
    text = message.strip(BLANK)
    if not text.startswith(b"{"):
        return None
    try:
        verb = _verbs.decode(text).do
    except (msgspec.DecodeError, UnicodeDecodeError):
        return None
    if len(text) > MOST_CONTROL and verb not in LONG_VERBS:
        return None
    try:
        found: Control = _controls.decode(text)
    except msgspec.ValidationError as error:
        raise ValueError(f"{error}; see docs/serve.md for what may be done") from None
    return found


def is_text(message: bytes) -> bool:
    """Whether a message is neither XML nor JSON."""
    return not message.lstrip(BLANK).startswith((b"<", b"{", b"["))


def stop_failure(error: Exception) -> str:
    """Writes the answer to a stop that may not have been made."""
    return json_answer("failed", why=f"the robot may not stop ({error}): use the switch that cuts the power")


def json_answer(what: str, **values: object) -> str:
    """Writes an answer that is not BML, as JSON."""
    return msgspec.json.encode({"told": what} | values).decode()
