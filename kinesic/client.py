"""Client of `kinesic serve`, based on the standard library only.

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
import selectors
import socket
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import suppress
from html import unescape
from selectors import EVENT_READ
from types import TracebackType
from typing import Self
from xml.parsers import expat

DEFAULT_PORT = 8864  # TCP port of `kinesic serve`
PORT = DEFAULT_PORT  # deprecated alias
_MESSAGE_END = b"\0"
_CHUNK_SIZE = 65_536  # [bytes] largest number of bytes per read
_UNNAMED_BLOCK = "block"  # id that the server assigns to a block without one
_ID_SEARCH_LENGTH = 65_536  # [characters] length of a broken document searched for its id, as on the server
# Comments and CDATA sections, closed or not, so that the search takes linear time; or the id of a <bml>.
_BROKEN_ID_PATTERN = re.compile(
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
    """Connection to a `kinesic serve` server.

    Messages from the server are BML feedback (XML) or answers to control messages (JSON). One thread may send while
    another one receives.
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = DEFAULT_PORT, *, token: str | None = None, timeout: float = 10.0
    ) -> None:
        """Connect to a server.

        Args:
            host: host name or address of the server.
            port: port of the server.
            token: token, if the server requires one.
            timeout: time limit [s] for connecting and for sending a message.

        Raises:
            OSError: no server listens at this address.
            PermissionError: the token is wrong or missing.
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
        """Send a BML document to the server.

        It is performed as soon as its composition allows.

        Raises:
            OSError: the connection is closed.
        """
        self.send_bytes(bml.encode())

    def send_bytes(self, message: bytes) -> None:
        """Send a message as raw bytes, followed by a NUL byte.

        It must not contain a NUL byte.

        Raises:
            OSError: the connection is closed.
        """
        self._socket.sendall(message + _MESSAGE_END)

    def do(self, verb: str, **values: object) -> None:
        """Send a control message such as stop, resume, style or ping.

        Raises:
            OSError: the connection is closed.
        """
        self.send(json.dumps({"do": verb} | values))

    def stop(self) -> None:
        """Request a minimum-time stop of the robot, without waiting for it.

        Blocks are refused until `resume`.
        """
        self.do("stop")

    def receive(self, timeout: float | None = None) -> str | None:
        """Return the next message of the server, or None after a timeout.

        Args:
            timeout: maximum waiting time [s]; None waits without a limit.

        Raises:
            ConnectionError: the server has closed the connection.
        """
        while not self._messages:
            if not self._is_heard(timeout):
                return None
            data = self._socket.recv(_CHUNK_SIZE)
            if not data:
                raise ConnectionError("the server has closed the connection")
            *whole, rest = (self._rest + data).split(_MESSAGE_END)
            self._rest = bytearray(rest)
            self._messages += (message.decode().strip() for message in whole)
        return self._messages.popleft()

    def perform(self, bml: str) -> Iterator[str]:
        """Send a document and yield messages until its block ends.

        The messages also end with the refusal of the block.

        Args:
            bml: document in XML or JSON with a unique id, which identifies its end.

        Raises:
            ConnectionError: the server has closed the connection.
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
        """Close the connection.

        Sent documents are still performed. A `receive` in another thread ends.
        """
        with suppress(OSError):  # the server may have disconnected
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def _is_heard(self, timeout: float | None) -> bool:
        """Wait for data from the server, and return False on timeout.

        The timeout of the socket itself applies to sending, possibly in another thread.
        """
        # Neither epoll nor kqueue reports a socket that another thread closes; poll and select do.
        waiter = getattr(selectors, "PollSelector", selectors.SelectSelector)
        with waiter() as waiting:
            waiting.register(self._socket, EVENT_READ)
            return bool(waiting.select(timeout))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class StopLine:
    """Connection that only stops the robot, independent of all other clients."""

    def __init__(
        self, host: str = "127.0.0.1", port: int = DEFAULT_PORT, *, token: str | None = None, timeout: float = 10.0
    ) -> None:
        """Connect to a server.

        Args:
            host: host name or address of the server.
            port: port of the server.
            token: token, if the server requires one.
            timeout: time limit [s] for connecting.

        Raises:
            OSError: no server listens at this address, or the server accepts no further stop line.
            PermissionError: the token is wrong or missing.
        """
        self._client = Client(host, port, token=token, timeout=timeout)
        self._owed = 0  # expected answers to stops
        try:
            self._client.do("stop_line")
            _expect("stop_line", self._answer(timeout))
        except BaseException:
            self._client.close()
            raise

    def stop(self, timeout: float = 1.0) -> None:
        """Stop the robot in minimum time and wait for the acknowledgement.

        Blocks are refused until `resume`.

        Args:
            timeout: maximum waiting time [s].

        Raises:
            OSError: the connection is closed, the stop failed, or there is no answer in time: switch off the power.
        """
        self._client.do("stop")
        self._owed += 1
        while self._owed:  # late answers to earlier stops do not count for this one
            answer = self._answer(timeout)
            self._owed -= 1
        _expect("stopped", answer)

    def close(self) -> None:
        """Close the connection."""
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


def _expect(kind: str, answer: Mapping[str, str]) -> None:
    if answer.get("told") != kind:
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
        ids = (match[1] or match[2] for match in _BROKEN_ID_PATTERN.finditer(bml, 0, _ID_SEARCH_LENGTH))
        return unescape(next(filter(None, ids), "")).strip() or _UNNAMED_BLOCK


class _BlockFound(Exception):  # noqa: N818 - ends the parser, not an error
    """Exception with the first <bml>'s id, raised to end the parser."""


def _xml_id(bml: str) -> str:
    """Return the id of an XML document's first <bml>, or `block`.

    Raises:
        ExpatError: the document is broken before its <bml>.
    """

    def begin(name: str, attributes: dict[str, str]) -> None:
        if name.rpartition(":")[2] == "bml":
            raise _BlockFound(attributes.get("id", ""))

    parser = expat.ParserCreate()  # it respects the declared encoding, like the server
    parser.StartElementHandler = begin
    try:
        parser.Parse(bml.encode(errors="replace"), True)
    except _BlockFound as block_found:
        return str(block_found).strip() or _UNNAMED_BLOCK
    return _UNNAMED_BLOCK


def _refuses(message: str, name: str) -> bool:
    """Return whether a message refuses a block."""
    head, _, text = message.partition(">")
    nothing = "PARSING_FAILURE" in head or text.startswith(("rule ", "not performed"))
    return head.startswith("<warningFeedback") and f' id="{name}"' in head and nothing
