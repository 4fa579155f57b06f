"""Connections of the tools to the server."""

import json
from contextlib import ExitStack
from functools import partial

from kinesic.client import Client, StopLine
from kinesic.mcp.direct_line import DirectLine
from kinesic.mcp.document_line import DocumentLine, RobotAnswer
from kinesic.mcp.errors import RobotError

STOP_TIMEOUT = 1.0  # [s] time limit for the answer to an emergency stop
STATUS_TIMEOUT = 5.0  # [s] time limit for the answer to a status request
CONNECT_TIMEOUT = 10.0  # [s] time limit for the first answer on a new connection
MIN_STATUS_INTERVAL = 0.025  # [s] shortest time between two status requests; the server accepts 50 per second


class RobotLine:
    """Connections to the server: documents, previews, status and stops separately.

    Each has separate threads, so that neither a stop nor the status waits for a document.
    """

    def __init__(self, host: str, port: int, *, token: str | None = None) -> None:
        """Open the connections for documents, previews, status and stops.

        Raises:
            OSError: no server listens at this address.
            PermissionError: the token is wrong or missing.
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
            self.previews = DocumentLine(connect)
            opened.callback(self.previews.close)
            self._opened = opened.pop_all()

    async def stop(self) -> None:
        """Stop the robot in minimum time.

        Raises:
            RobotError: the server does not confirm the stop.
        """
        try:
            await self._stops.request()
        except OSError as error:
            raise RobotError(f"{error}: use the switch that cuts the power") from None

    async def status(self) -> RobotAnswer:
        """Return the server's answer to a status request.

        Raises:
            RobotError: there is no answer in time.
        """
        try:
            return await self._statuses.request()
        except OSError as error:
            raise RobotError(f"the server is gone ({error}): start it again") from None

    async def resume(self) -> None:
        """Send a resume request after all documents sent earlier.

        Raises:
            RobotError: the server has closed the connection.
        """
        await self.documents.send(lambda: json.dumps({"do": "resume"}))

    def close(self) -> None:
        """Close all connections to the server.

        The server still performs blocks that were sent.
        """
        self._opened.close()


def _connect(host: str, port: int, token: str | None) -> Client:
    """Connect to the server and wait for its answer to a ping.

    The server closes a connection that stays silent for 10 s.

    Raises:
        OSError: no server listens, or it does not answer.
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
