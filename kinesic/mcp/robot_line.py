"""Connections of the tools to the server that performs."""

import json
from contextlib import ExitStack
from functools import partial

from kinesic.client import Client, StopLine
from kinesic.mcp.direct_line import DirectLine
from kinesic.mcp.document_line import DocumentLine, RobotAnswer
from kinesic.mcp.errors import RobotError

STOP_TIMEOUT = 1.0  # [s] for the answer to a stop
STATUS_TIMEOUT = 5.0  # [s] for the status
CONNECT_TIMEOUT = 10.0  # [s] for the first answer
MIN_STATUS_INTERVAL = 0.025  # [s] between two questions: the server takes 50 a second


class RobotLine:
    """Separate connections for documents, status and stops.

    Each has threads of its own, so that neither a stop nor the status waits for a document.
    """

    def __init__(self, host: str, port: int, *, token: str | None = None) -> None:
        """Connect.

        Raises:
            OSError: nobody is there.
            PermissionError: the token is wrong, or missing.
        """
        with ExitStack() as opened:
            self._stops = DirectLine(
                partial(StopLine, host, port, token=token, timeout=STOP_TIMEOUT), _stop, name="stop"
            )
            opened.callback(self._stops.close)
            connect = partial(_connect, host, port, token)
            self._statuses = DirectLine(connect, _ask_status, name="status", interval=MIN_STATUS_INTERVAL)
            opened.callback(self._statuses.close)
            self.documents = DocumentLine(connect)
            opened.callback(self.documents.close)
            self._opened = opened.pop_all()

    async def stop(self) -> None:
        """Stop the robot in the least time.

        Raises:
            RobotError: the server does not confirm that it has stopped.
        """
        try:
            await self._stops.request()
        except OSError as error:
            raise RobotError(f"{error}: use the switch that cuts the power") from None

    async def status(self) -> RobotAnswer:
        """Return the robot's state, and the last messages of feedback.

        Raises:
            RobotError: nobody answers.
        """
        try:
            return {**await self._statuses.request(), "feedback": self.documents.feedback}
        except OSError as error:
            raise RobotError(f"the server is gone ({error}): start it again") from None

    async def resume(self) -> None:
        """Resume after a stop, behind all documents that were sent before.

        Raises:
            RobotError: the server is gone.
        """
        await self.documents.send(lambda: json.dumps({"do": "resume"}))

    def close(self) -> None:
        """Close the connections, and leave blocks that were sent to the server."""
        self._opened.close()


def _connect(host: str, port: int, token: str | None) -> Client:
    """Connect, and send a first message.

    The server closes a connection on which nothing comes for 10 s.

    Raises:
        OSError: nobody is there, or nobody answers.
    """
    client = Client(host, port, token=token)
    try:
        client.do("ping")
        if client.receive(CONNECT_TIMEOUT) is None:
            raise TimeoutError(f"no answer came in {CONNECT_TIMEOUT:g} s")
    except OSError:
        client.close()
        raise
    return client


def _stop(line: StopLine) -> None:
    line.stop(STOP_TIMEOUT)


def _ask_status(client: Client) -> RobotAnswer:
    client.do("status")
    message = client.receive(STATUS_TIMEOUT)
    if message is None:
        raise TimeoutError(f"no status came in {STATUS_TIMEOUT:g} s")
    if not message.startswith("{"):
        raise ConnectionError(message)  # a refusal as feedback
    answer: RobotAnswer = json.loads(message)
    return answer
