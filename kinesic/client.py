"""Talks to `kinesic serve`, with nothing but the standard library.

Example:
    ```python
    from kinesic.client import Client

    with Client() as robot:
        for message in robot.perform('<bml id="b1"><head id="nod" lexeme="NOD" start="0"/></bml>'):
            print(message)
    ```
"""

import json
import re
import socket
from collections import deque
from collections.abc import Iterator, Mapping
from html import unescape
from selectors import EVENT_READ, DefaultSelector
from types import TracebackType
from typing import Self
from xml.parsers import expat

PORT = 8864
_END = b"\0"
_CHUNK = 65_536  # [bytes] read at once
_UNNAMED_BLOCK = "block"  # id that the server gives to a block without one
_ID_SEARCH = 65_536  # [letters] of a broken document in which its id is looked for, as the server does
# Comments and CDATA, which end with the text at the latest, so that each letter is read once; or the id of a <bml>.
_BROKEN_ID = re.compile(
    r"""<!--(?:.*?-->|.*)|<!\[CDATA\[(?:.*?\]\]>|.*)|<(?:\w+:)?bml\b[^<>]*?\sid\s*=\s*(?:"([^"]+)"|'([^']+)')""",
    re.DOTALL | re.ASCII,
)
_ATTRIBUTE_ESCAPES = str.maketrans(
    {
        "&": "&amp;",
        "<": "&lt;",
        ">": "&gt;",
        '"': "&quot;",
        "\r": "&#13;",
        "\n": "&#10;",
        "\t": "&#09;",
    }
)


class Client:
    """A connection to a server. Messages are BML feedback (XML), or answers to control messages (JSON).

    One thread may send while another one receives.
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = PORT, *, token: str | None = None, timeout: float = 10.0
    ) -> None:
        """Connects.

        Args:
            host: of the server.
            port: of the server.
            token: that the server asks for.
            timeout: [s] to connect, and to hand a message over.

        Raises:
            OSError: nobody is there.
            PermissionError: the token is wrong, or missing.
        """
        self._socket = socket.create_connection((host, port), timeout)
        self._rest, self._messages = bytearray(), deque[str]()
        if token is not None:
            self.do("hello", token=token)
            answer = json.loads(self.receive(timeout) or "{}")
            if answer.get("told") != "welcome":
                self.close()
                raise PermissionError(answer.get("why", "the server does not answer"))

    def send(self, bml: str) -> None:
        """Sends a document; it is performed as soon as its composition allows.

        Raises:
            OSError: the server is gone.
        """
        self.send_bytes(bml.encode())

    def send_bytes(self, message: bytes) -> None:
        """Sends a message as it is; it must not contain a NUL byte.

        Raises:
            OSError: the server is gone.
        """
        self._socket.sendall(message + _END)

    def do(self, verb: str, **values: object) -> None:
        """Sends a control message: stop, resume, interrupt, style, status, ping (see docs/serve.md).

        Raises:
            OSError: the server is gone.
        """
        self.send(json.dumps({"do": verb} | values))

    def stop(self) -> None:
        """Stops the robot in the least time; no block is taken until `resume`."""
        self.do("stop")

    def receive(self, timeout: float | None = None) -> str | None:
        """Receives the next message; None when none came in time.

        Args:
            timeout: [s] to wait; None: as long as it takes.

        Raises:
            ConnectionError: the server is gone.
        """
        while not self._messages:
            if not self._is_heard(timeout):
                return None
            data = self._socket.recv(_CHUNK)
            if not data:
                raise ConnectionError("the server has closed the connection")
            *whole, rest = (self._rest + data).split(_END)
            self._rest = bytearray(rest)
            self._messages += (message.decode().strip() for message in whole)
        return self._messages.popleft()

    def perform(self, bml: str) -> Iterator[str]:
        """Sends a document, and yields all messages until its block has ended or was refused.

        Args:
            bml: as XML or JSON, with an id of its own, by which its end is known.

        Raises:
            ConnectionError: the server is gone.
        """
        name = _block_id(bml).translate(_ATTRIBUTE_ESCAPES)
        ends = (f'<blockProgress xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{name}:end"',)
        self.send(bml)
        while True:
            message = self.receive()
            if message is None:
                return
            yield message
            if message.startswith(ends) or _refuses(message, name):
                return

    def close(self) -> None:
        """Closes the connection; what was sent is performed all the same."""
        self._socket.close()

    def _is_heard(self, timeout: float | None) -> bool:
        """Waits for a message; the socket's own timeout is that of sending, maybe in another thread."""
        with DefaultSelector() as waiting:
            waiting.register(self._socket, EVENT_READ)
            return bool(waiting.select(timeout))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class StopLine:
    """A connection that only stops the robot: the server reads it apart from all other clients, whatever these send."""

    def __init__(
        self, host: str = "127.0.0.1", port: int = PORT, *, token: str | None = None, timeout: float = 10.0
    ) -> None:
        """Connects.

        Args:
            host: of the server.
            port: of the server.
            token: that the server asks for.
            timeout: [s] to connect.

        Raises:
            OSError: nobody is there, or the server takes no further stop line.
            PermissionError: the token is wrong, or missing.
        """
        self._client = Client(host, port, token=token, timeout=timeout)
        self._owed = 0  # answers to stops
        try:
            self._client.do("stop_line")
            _expect("stop_line", self._answer(timeout))
        except BaseException:
            self._client.close()
            raise

    def stop(self, timeout: float = 1.0) -> None:
        """Stops the robot in the least time, and waits until the server says so; no block is taken until `resume`.

        Args:
            timeout: [s] to wait.

        Raises:
            OSError: the server is gone, cannot stop, or does not answer in time: use the switch that cuts the power.
        """
        self._client.do("stop")
        self._owed += 1
        while self._owed:  # the answer to an earlier stop, which came too late, is none to this one
            answer = self._answer(timeout)
            self._owed -= 1
        _expect("stopped", answer)

    def close(self) -> None:
        """Closes the connection."""
        self._client.close()

    def _answer(self, timeout: float) -> dict[str, str]:
        message = self._client.receive(timeout)
        if message is None:
            raise ConnectionError(f"no answer came in {timeout:g} s")
        answer: dict[str, str] = json.loads(message)
        return answer

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _expect(told: str, answer: Mapping[str, str]) -> None:
    if answer.get("told") != told:
        raise ConnectionError(answer.get("why", f"the server answers {answer}"))


def _block_id(bml: str) -> str:
    """Return the id of a document's block, or `block` without one."""
    if bml.lstrip().startswith("{"):
        try:
            return str(json.loads(bml).get("id", _UNNAMED_BLOCK))
        except ValueError:
            return _UNNAMED_BLOCK
    try:
        return _xml_id(bml)
    except expat.ExpatError:
        found = (each[1] or each[2] for each in _BROKEN_ID.finditer(bml, 0, _ID_SEARCH))
        return unescape(next(filter(None, found), "")).strip() or _UNNAMED_BLOCK


class _BlockFound(Exception):  # noqa: N818 - ends the parser, and is no error
    """The id of the first <bml>."""


def _xml_id(bml: str) -> str:
    """Return the id of the first <bml> of a document in XML.

    Raises:
        ExpatError: the document is broken before its <bml>.
    """

    def begin(name: str, attributes: dict[str, str]) -> None:
        if name.rpartition(":")[2] == "bml":
            raise _BlockFound(attributes.get("id", ""))

    parser = expat.ParserCreate()  # the server decodes as the declaration says, too
    parser.StartElementHandler = begin
    try:
        parser.Parse(bml.encode(errors="replace"), True)
    except _BlockFound as found:
        return str(found).strip() or _UNNAMED_BLOCK
    return _UNNAMED_BLOCK


def _refuses(message: str, name: str) -> bool:
    """Says whether a message refuses a block."""
    head, _, text = message.partition(">")
    nothing = "PARSING_FAILURE" in head or text.startswith(("rule ", "not performed"))
    return head.startswith("<warningFeedback") and f' id="{name}"' in head and nothing
