"""A client by WebSocket: one message is one message."""

from asyncio import sleep
from collections import deque
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from http import HTTPStatus

from websockets.frames import Frame, Opcode
from websockets.http11 import Request
from websockets.protocol import Event, State
from websockets.server import ServerProtocol

from kinesic.serve.wire.origin import Access, Rejection, find_rejection
from kinesic.serve.wire.pages import NO_FILES, WebFile, asks_for_file, show_file
from kinesic.serve.wire.quotas import Quotas, TokenBucket
from kinesic.serve.wire.transport import HalfError, Transport

BEARER = "Bearer "
PIECE = 2048  # [bytes] parsed at once, which may be hundreds of frames
DATA = (Opcode.TEXT, Opcode.BINARY, Opcode.CONT)


class WebSocket:
    """Messages over a WebSocket, whose protocol is that of the library `websockets`."""

    lingers = False

    def __init__(self, line: Transport, first: bytes, rules: Quotas) -> None:
        """Takes over a connection whose request is still to be read.

        Args:
            line: to the client.
            first: what has been read already.
            rules: how long a message may be, and in how many fragments.
        """
        self._line, self._rules = line, rules
        self._frames = TokenBucket(rules.fragments / 2, rules.fragments)
        self._protocol = ServerProtocol(max_size=rules.message)
        self._protocol.receive_data(first)
        self._unread = b""  # what the client has said and is still to be parsed
        self._events = deque[Event]()  # that were parsed and not looked at yet
        self._pieces: list[bytes] = []  # of the message that has begun
        self._half = False  # a message has begun and not ended

    def move(self, line: Transport) -> None:
        """Goes on over another transport of the same connection."""
        self._line = line

    async def open(
        self,
        access: Access,
        is_token: Callable[[str | None], bool],
        authorities: frozenset[str],
        files: Mapping[str, WebFile] = NO_FILES,
    ) -> bool:
        """Reads the request and answers it; says whether the token came with it.

        Args:
            access: who may connect.
            is_token: says whether a token is right.
            authorities: what the request's `Host` may be.
            files: that may be requested instead, by their path.

        Raises:
            HalfError: there is no request, it is refused, or a file was all that was requested.
        """
        while not (events := self._protocol.events_received()):
            if not await self._receive(hurry=True):
                raise HalfError("the connection ended")
        request = events[0]
        if not isinstance(request, Request):
            raise HalfError("no request")
        headers = request.headers
        tokens = [value.removeprefix(BEARER) for value in headers.get_all("Authorization")]
        shown = len(tokens) == 1 and is_token(tokens[0])
        if shown and "Origin" not in headers:
            rejection = None  # no page can send this header, and a program may call the server what it likes
        elif access.token is not None and tokens and not shown:
            rejection = Rejection(HTTPStatus.UNAUTHORIZED, "the token is wrong")
        else:
            rejection = find_rejection(headers, authorities, access.origins)
        if rejection is None and files and asks_for_file(request):
            response = show_file(request.path, files)
        elif rejection is None:
            response = self._protocol.accept(request)
        else:
            response = self._protocol.reject(rejection.status, f"{rejection.why}\n")
        self._protocol.send_response(response)
        await self._flush()
        if self._protocol.state is not State.OPEN:
            await self._line.close()
            raise HalfError("refused, or a file")
        return shown

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Messages as they come, until the client closes.

        Args:
            hurry: whether the client has to say something soon.

        Raises:
            ValueError: a message is too long.
            HalfError: one has begun and does not end.
        """
        while True:
            for frame in self._read_frames():
                if frame.opcode in DATA:
                    self._pieces.append(bytes(frame.data))
                    if frame.fin:
                        message, self._pieces = b"".join(self._pieces), []
                        yield message
                self._half = bool(self._pieces)
            await self._flush()
            if self._protocol.parser_exc is not None:
                raise ValueError(f"at most {self._rules.message} bytes are read: {self._protocol.parser_exc}")
            if self._protocol.state is not State.OPEN or not await self._receive(hurry=hurry()):
                return

    def _read_frames(self) -> Iterator[Frame]:
        self._events.extend(self._protocol.events_received())
        while self._events:
            event = self._events.popleft()
            if not self._frames.take():
                most = self._rules.fragments
                raise ValueError(f"at most {most} frames are read at once, {most // 2} a second: send fewer fragments")
            if isinstance(event, Frame):
                yield event

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
        """Reads and parses a little, so that others have their turn in between; False at the end."""
        if not self._unread:
            self._unread = await self._line.read(hurry=self._half or hurry)
            if not self._unread:
                self._protocol.receive_eof()
                return False
        else:
            await sleep(0)
        piece, self._unread = self._unread[:PIECE], self._unread[PIECE:]
        self._half = True
        self._protocol.receive_data(piece)
        return True

    async def _flush(self) -> None:
        await self._line.write(self._protocol.data_to_send())
