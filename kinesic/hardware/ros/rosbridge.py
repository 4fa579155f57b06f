"""Client of rosbridge, a WebSocket server that connects other programs to ROS."""

from collections.abc import Mapping

import msgspec
from websockets.exceptions import InvalidURI, WebSocketException
from websockets.sync.client import connect

from kinesic.body.config import ConfigError

DEFAULT_ADDRESS = "ws://localhost:9090"  # address of rosbridge_server on this machine
CONNECTION_TIMEOUT = 3.0  # [s] longest wait for the connection
MAX_KEPT_ERRORS = 20  # largest number of kept error messages
MAX_ERROR_LENGTH = 300  # [characters] longest kept error message

Message = Mapping[str, object]  # JSON object


class Rosbridge:
    """Connection to a rosbridge server.

    `errors` has the latest messages with which the server refused a request.
    """

    def __init__(self, address: str = DEFAULT_ADDRESS) -> None:
        """Connect to a server.

        Args:
            address: WebSocket address, such as ws://robot.local:9090.

        Raises:
            ConfigError: the address is invalid, or no rosbridge answers.
        """
        self.address = address
        self.errors: tuple[str, ...] = ()  # at most the last 20
        try:
            self._socket = connect(address, open_timeout=CONNECTION_TIMEOUT, compression=None)
        except InvalidURI:
            raise ConfigError(f"{address}: must be a WebSocket address, such as {DEFAULT_ADDRESS}") from None
        except (OSError, WebSocketException) as error:
            raise ConfigError(
                f"{address}: no rosbridge answers: {error}; "
                "start it (ros2 launch rosbridge_server rosbridge_websocket_launch.xml), and check the address"
            ) from None

    def send(self, operation: str, **fields: object) -> None:
        """Send an operation of the rosbridge protocol.

        Raises:
            ConfigError: the connection has ended.
        """
        text = msgspec.json.encode({"op": operation, **fields}).decode()
        try:
            self._socket.send(text)
        except (OSError, WebSocketException) as error:
            raise self._ended(error) from None

    def receive(self, timeout: float) -> Message | None:
        """Return the next operation, or None after a timeout [s].

        Error messages of the server are also kept in `errors`.

        Raises:
            ConfigError: the connection has ended.
        """
        try:
            text = self._socket.recv(max(0.0, timeout))
        except TimeoutError:
            return None
        except (OSError, WebSocketException) as error:
            raise self._ended(error) from None
        operation = _decode(text)
        if is_error(operation):
            self.errors = (*self.errors, str(operation.get("msg", ""))[:MAX_ERROR_LENGTH])[-MAX_KEPT_ERRORS:]
        return operation

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()

    def _ended(self, error: Exception) -> ConfigError:
        return ConfigError(f"{self.address}: the connection to rosbridge has ended: {error}")


def is_error(operation: Message) -> bool:
    """Return whether an operation reports an error of the server."""
    return operation.get("op") == "status" and operation.get("level") == "error"


def _decode(text: str | bytes) -> Message:
    """Return the JSON object of a message, empty if it is none."""
    try:
        return msgspec.json.decode(text, type=dict[str, object])
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return {}
