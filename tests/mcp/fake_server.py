"""Stub server with scripted answers, and tool connections to it."""

import socket
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from threading import Thread

from kinesic.mcp.robot_line import RobotLine

WARNING = '<warningFeedback xmlns="x" id="{}" type="IMPOSSIBLE_TO_SCHEDULE">{}</warningFeedback>'
PREDICTION = '<predictionFeedback xmlns="x"><bml id="{}" globalStart="1" globalEnd="2" /></predictionFeedback>'
PROGRESS = '<blockProgress xmlns="x" id="{}:{}" globalTime="1" />'
PINGED = '{"told": "pong", "id": ""}'
Say = Callable[[str], None]


@dataclass
class FakeServer:
    """Stub server with scripted answers that may end a connection."""

    answer: Callable[[str, Say], None]
    received: list[str] = field(default_factory=list)  # messages of all connections in order
    stops: int = 0
    silent_stops: int = 0  # number of unanswered stops

    def serve(self, connection: socket.socket) -> None:
        with connection, suppress(OSError):  # the client may disconnect at any time
            rest = b""
            while data := connection.recv(65_536):
                *whole, rest = (rest + data).split(b"\0")
                for message in whole:
                    try:
                        self._take(message.decode(), lambda text: connection.sendall(text.encode() + b"\0"))
                    except EOFError:
                        return

    def _take(self, message: str, say: Say) -> None:
        self.received.append(message)
        match message:
            case '{"do": "ping"}':
                say(PINGED)
            case '{"do": "stop_line"}':
                say('{"told": "stop_line"}')
            case '{"do": "stop"}' if self.stops < self.silent_stops:
                self.stops += 1
                raise EOFError
            case '{"do": "stop"}':
                self.stops += 1
                say('{"told": "stopped"}')
            case '{"do": "status"}':
                say('{"told": "status", "state": "resting", "stops": 3}')
            case _:
                self.answer(message, say)


@contextmanager
def line(answer: Callable[[str, Say], None], *, silent_stops: int = 0) -> Iterator[tuple[RobotLine, FakeServer]]:
    """Open tool connections to a stub server."""
    listener, server = socket.create_server(("127.0.0.1", 0)), FakeServer(answer, silent_stops=silent_stops)

    def accept() -> None:
        while True:
            try:
                connection = listener.accept()[0]
            except OSError:
                return
            Thread(target=server.serve, args=(connection,), daemon=True).start()

    with closing(listener):
        Thread(target=accept, daemon=True).start()
        with closing(RobotLine("127.0.0.1", listener.getsockname()[1])) as robot:
            yield robot, server
