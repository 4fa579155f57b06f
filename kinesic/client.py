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
from selectors import EVENT_READ, DefaultSelector
from types import TracebackType
from typing import Self

PORT = 8864
_END = b"\0"
_CHUNK = 65_536  # [bytes] read at once
_ID = re.compile(r"""<(?:\w+:)?bml\b[^<>]*?\sid\s*=\s*["']([^"']+)["']""")


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
        name = _block_id(bml)
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
    """The id of a document's block; `block` where it has none, or is no document."""
    if bml.lstrip().startswith("{"):
        try:
            return str(json.loads(bml).get("id", "block"))
        except ValueError:
            return "block"
    found = _ID.search(bml)
    return found[1] if found else "block"


def _refuses(message: str, name: str) -> bool:
    """Says whether a message refuses a block."""
    head, _, text = message.partition(">")
    nothing = "PARSING_FAILURE" in head or text.startswith(("rule ", "not performed"))
    return head.startswith("<warningFeedback") and f' id="{name}"' in head and nothing
