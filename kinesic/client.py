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
import selectors
import socket
from collections import deque
from collections.abc import Container, Iterator, Mapping
from contextlib import suppress
from selectors import EVENT_READ
from types import TracebackType
from typing import Self

from kinesic.client_feedback import document_id, refuses_block

DEFAULT_PORT = 8864  # TCP port of `kinesic serve`
PORT = DEFAULT_PORT  # deprecated alias
_MESSAGE_END = b"\0"
_CHUNK_SIZE = 65_536  # [bytes] largest number of bytes per read
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

    def converse(self, *, on: bool = True, amount: float = 1.0, fillers: bool = False) -> None:
        """Begin or end a conversation, in which the robot attends to people.

        Args:
            on: whether the robot converses.
            amount: amount of movement, 0..1.
            fillers: whether the robot says a short filler while an answer takes long.
        """
        self.do("converse", on=on, amount=amount, fillers=fillers)

    def people(
        self, places: Mapping[str, tuple[float, float, float]], *, looking: Container[str] = (), age: float = 0.0
    ) -> None:
        """Report all people seen by a tracker, with their positions.

        Call it 2 to 20 times a second.

        Args:
            places: position [m] of the eyes by id of the person: forward, left, up from the robot's base.
            looking: ids of the people who look at the robot.
            age: time [s] since the measurement.
        """
        seen = [{"id": id, "at": place, "looks": id in looking} for id, place in places.items()]
        self.do("people", people=seen, age=age)

    def heard(
        self,
        *,
        voice: bool | None = None,
        text: str | None = None,
        final: bool = False,
        who: str | None = None,
        age: float = 0.0,
    ) -> None:
        """Report the beginning or end of a person's voice, or recognised words.

        Args:
            voice: whether the voice began (True) or ended (False); None: only words are reported.
            text: all recognised words of the turn; None: only the voice is reported.
            final: whether the recogniser will not change these words.
            who: id of the person; None: unknown.
            age: time [s] since the voice began or ended.
        """
        self.do("heard", voice=voice, text=text, final=final, who=who, age=age)

    def turn(self, yours: float) -> None:
        """Report the probability that the person yields the turn to the robot."""
        self.do("turn", yours=yours)

    def think(self, *, on: bool = True) -> None:
        """Report whether an answer of the robot is being prepared."""
        self.do("think", on=on)

    def duck(self, *, on: bool = True) -> None:
        """Mute the robot's speech while a person speaks, or unmute it.

        The motion goes on. The mute ends after 5 s.
        """
        self.do("duck", on=on)

    def interrupt(self, block: str | None = None, *, yield_: bool = False) -> None:
        """Interrupt one block or all blocks, with a smooth end of motion.

        Args:
            block: id of the block; None: all blocks.
            yield_: whether the robot yields to a person: arms stop and hold first, and a `yielded` message has the
                text heard so far.
        """
        self.do("interrupt", block=block, **{"yield": yield_})

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
        name = document_id(bml).translate(_ATTRIBUTE_ESCAPES)
        ends = (f'<blockProgress xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{name}:end"',)
        self.send(bml)
        while True:
            message = self.receive()
            if message is None:
                return
            yield message
            if message.startswith(ends) or refuses_block(message, name):
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
