"""A client by WebSocket: one message is one message."""

from collections.abc import AsyncIterator, Callable
from urllib.parse import urlsplit

from websockets.frames import Frame, Opcode
from websockets.http11 import Request
from websockets.protocol import State
from websockets.server import ServerProtocol

from kinesic.serve.transport import HalfError, Transport

HERE = ("localhost", "127.0.0.1", "::1", None)  # whose pages may connect without a token
DATA = (Opcode.TEXT, Opcode.BINARY, Opcode.CONT)


class WebSocket:
    """Messages over a WebSocket, whose protocol is that of the library `websockets`."""

    lingers = False

    def __init__(self, line: Transport, first: bytes, most: int) -> None:
        """Takes over a connection whose request is still to be read.

        Args:
            line: to the client.
            first: what has been read already.
            most: how long a message may be [bytes].
        """
        self._line, self._most = line, most
        self._protocol = ServerProtocol(max_size=most)
        self._protocol.receive_data(first)
        self._half = False  # a message has begun and not ended

    async def open(self, is_token: Callable[[str | None], bool], *, needs_token: bool) -> bool:
        """Reads the request and answers it; says whether a token came with it that is right.

        A browser says which page asks: pages from elsewhere must bring the token, or any page could move the robot.

        Args:
            is_token: says whether a token is right.
            needs_token: whether clients need one.

        Raises:
            HalfError: there is no request, or it is refused.
        """
        while not (events := self._protocol.events_received()):
            if not await self._receive(hurry=True):
                raise HalfError("the connection ended")
        request = events[0]
        if not isinstance(request, Request):
            raise HalfError("no request")
        token = request.headers.get("Authorization", "").removeprefix("Bearer ") or None
        origin = request.headers.get("Origin")
        elsewhere = origin is not None and urlsplit(origin).hostname not in HERE
        if token is not None and needs_token and not is_token(token):
            response = self._protocol.reject(401, "the token is wrong\n")
        elif elsewhere and not needs_token:
            response = self._protocol.reject(403, f"pages of {origin} may not connect without a token\n")
        else:
            response = self._protocol.accept(request)
        self._protocol.send_response(response)
        await self._flush()
        if self._protocol.state is not State.OPEN:
            await self._line.close()
            raise HalfError("refused")
        return token is not None

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Messages as they come, until the client closes.

        Args:
            hurry: whether the client has to say something soon.

        Raises:
            ValueError: a message is too long.
            HalfError: one has begun and does not end.
        """
        pieces: list[bytes] = []
        while True:
            for event in self._protocol.events_received():
                if isinstance(event, Frame) and event.opcode in DATA:
                    pieces.append(bytes(event.data))
                    if event.fin:
                        yield b"".join(pieces)
                        pieces = []
                self._half = bool(pieces)
            await self._flush()
            if self._protocol.parser_exc is not None:
                raise ValueError(f"at most {self._most} bytes are read: {self._protocol.parser_exc}")
            if self._protocol.state is not State.OPEN or not await self._receive(hurry=hurry()):
                return

    async def send(self, message: str) -> None:
        """Sends a message.

        Raises:
            TimeoutError: the client does not read.
        """
        if self._protocol.state is State.OPEN:
            self._protocol.send_text(message.encode())
            await self._flush()

    async def close(self, code: int, why: str) -> None:
        """Ends the connection, and says why."""
        if self._protocol.state is State.OPEN:
            self._protocol.send_close(code, why[:100])
            await self._flush()
        await self._line.close()

    async def _receive(self, *, hurry: bool) -> bool:
        """Reads a little; False at the end."""
        data = await self._line.read(hurry=self._half or hurry)
        if data:
            self._half = True
            self._protocol.receive_data(data)
        else:
            self._protocol.receive_eof()
        return bool(data)

    async def _flush(self) -> None:
        await self._line.write(self._protocol.data_to_send())
