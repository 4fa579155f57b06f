"""WebSocket connections of clients."""

from asyncio import sleep
from collections import deque
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from http import HTTPStatus

from websockets.frames import Frame, Opcode
from websockets.http11 import Request
from websockets.protocol import Event, State
from websockets.server import ServerProtocol

from kinesic.serve.wire.origin import Access, Rejection, find_rejection
from kinesic.serve.wire.pages import NO_FILES, WebFile, asks_for_file, file_response
from kinesic.serve.wire.quotas import Quotas, TokenBucket
from kinesic.serve.wire.transport import HalfError, Transport

BEARER_PREFIX = "Bearer "  # text before the token in the Authorization header
PARSE_SIZE = 2048  # [bytes] data parsed before other tasks run; may contain hundreds of frames
DATA_OPCODES = (Opcode.TEXT, Opcode.BINARY, Opcode.CONT)  # frame types with message data


class WebSocket:
    """Message connection over a WebSocket, based on the `websockets` library."""

    lingers = False

    def __init__(self, line: Transport, first: bytes, rules: Quotas) -> None:
        """Wrap a connection whose HTTP request is not complete yet.

        Args:
            line: transport to the client.
            first: bytes that were read already.
            rules: limits for message size and fragments.
        """
        self._line, self._rules = line, rules
        self._frames = TokenBucket(rules.fragments / 2, rules.fragments)
        self._protocol = ServerProtocol(max_size=rules.message)
        self._protocol.receive_data(first)
        self._unread = b""  # received bytes that are not parsed yet
        self._events = deque[Event]()  # parsed events that are not handled yet
        self._pieces: list[bytes] = []  # of the incomplete message
        self._is_midway = False  # whether a message is incomplete

    def move(self, line: Transport) -> None:
        """Continue over another transport of the same connection."""
        self._line = line

    async def open(
        self,
        access: Access,
        is_token: Callable[[str | None], bool],
        authorities: frozenset[str],
        files: Mapping[str, WebFile] = NO_FILES,
    ) -> bool:
        """Answer the HTTP request and return whether it contained the token.

        Args:
            access: token and allowed origins.
            is_token: returns whether a token is correct.
            authorities: valid `Host` values.
            files: files that may be requested instead, by path.

        Raises:
            HalfError: the request is incomplete or refused, or it was for a file.
        """
        while not (events := self._protocol.events_received()):
            if not await self._receive(hurry=True):
                raise HalfError("the connection ended")
        request = events[0]
        if not isinstance(request, Request):
            raise HalfError("no request")
        headers = request.headers
        tokens = [value.removeprefix(BEARER_PREFIX) for value in headers.get_all("Authorization")]
        has_token = len(tokens) == 1 and is_token(tokens[0])
        if has_token and "Origin" not in headers:
            rejection = None  # browser pages cannot send this header, and a program may use any host name
        elif access.token is not None and tokens and not has_token:
            rejection = Rejection(HTTPStatus.UNAUTHORIZED, "the token is wrong")
        else:
            rejection = find_rejection(headers, authorities, access.origins)
        if rejection is None and files and asks_for_file(request):
            response = file_response(request.path, files)
        elif rejection is None:
            response = self._protocol.accept(request)
        else:
            response = self._protocol.reject(rejection.status, f"{rejection.why}\n")
        self._protocol.send_response(response)
        await self._flush()
        if self._protocol.state is not State.OPEN:
            await self._line.close()
            raise HalfError("refused, or a file")
        return has_token

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Yield messages until the client closes the connection.

        Args:
            hurry: returns whether the next message has a time limit.

        Raises:
            ValueError: a message exceeds the size limit.
            HalfError: the connection ended or stalled within a message.
        """
        while True:
            for frame in self._read_frames():
                if frame.opcode in DATA_OPCODES:
                    self._pieces.append(bytes(frame.data))
                    if frame.fin:
                        message, self._pieces = b"".join(self._pieces), []
                        yield message
                self._is_midway = bool(self._pieces)
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
                max_count = self._rules.fragments
                raise ValueError(
                    f"at most {max_count} frames at once and {max_count // 2} a second are read: send fewer fragments"
                )
            if isinstance(event, Frame):
                yield event

    async def send(self, message: str) -> None:
        """Send a message.

        Raises:
            TimeoutError: the client does not read.
        """
        if self._protocol.state is State.OPEN:
            self._protocol.send_text(message.encode())
            await self._flush()

    async def close(self, code: int, why: str) -> None:
        """Send the reason and end the connection."""
        if self._protocol.state is State.OPEN:
            self._protocol.send_close(code, why[:100])
            await self._flush()
        await self._line.close()

    async def _receive(self, *, hurry: bool) -> bool:
        """Read and parse some bytes, or return False at the end."""
        if not self._unread:
            self._unread = await self._line.read(hurry=self._is_midway or hurry)
            if not self._unread:
                self._protocol.receive_eof()
                return False
        else:
            await sleep(0)
        piece, self._unread = self._unread[:PARSE_SIZE], self._unread[PARSE_SIZE:]
        self._is_midway = True
        self._protocol.receive_data(piece)
        return True

    async def _flush(self) -> None:
        await self._line.write(self._protocol.data_to_send())
