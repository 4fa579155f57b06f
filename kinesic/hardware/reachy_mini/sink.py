"""Sink that performs on a Reachy Mini through its daemon.

The daemon has an HTTP and a WebSocket interface.
"""

import json
import time
from collections.abc import Callable
from urllib.error import URLError
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

from websockets.exceptions import WebSocketException
from websockets.sync.client import ClientConnection, connect

from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.reachy_mini.targets import Puppet, ReachyTarget

DEFAULT_ADDRESS = "http://localhost:8000"  # address of the daemon of a Reachy Mini Lite
TARGET_PERIOD = 0.02  # [s] between targets, as the daemon's motors are updated at 50 Hz
APPROACH_DURATION = 1.0  # [s] of the motion to the first target
REQUEST_TIMEOUT = 3.0  # [s] longest HTTP request
MAX_KEPT_REFUSALS = 20  # largest number of kept refusals
TIME_TOLERANCE = 1e-9  # [s] by which a command may come before the next target is due


class ReachyMini:
    """Sink that shows the motion of a humanoid on a Reachy Mini.

    It waits for the time of each target, so a performance takes its duration. The motors stay on at the end.
    """

    def __init__(
        self,
        robot: Robot,
        address: str = DEFAULT_ADDRESS,
        *,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Connect to the daemon and move to the rest posture.

        The motors are switched on.

        Args:
            robot: Humanoid whose commands are shown.
            address: Address of the daemon, such as http://reachy-mini.local:8000.
            now: Clock [s].
            sleep: Function that waits [s].

        Raises:
            ConfigError: the address is invalid, or no daemon answers.
        """
        self.refusals: list[str] = []  # reasons for which the daemon refused targets, at most the last 20
        self.sent_count = 0  # number of sent targets
        self._now, self._sleep, self._puppet = now, sleep, Puppet(robot)
        self._address = _check_address(address)
        self._start: float | None = None  # [s] clock at performance time 0
        self._due = 0.0  # [s] performance time of the next target
        self._post("motors/set_mode/enabled", {})
        self._approach(self._puppet.target(robot.skeleton.rest))
        self._socket = self._connect()

    def write(self, command: Command, /) -> None:
        """Send the target of a command at its time.

        At most 50 targets are sent per second.
        """
        if command.time < self._due - TIME_TOLERANCE:
            return
        now = self._now()
        self._start = now - command.time if self._start is None else self._start
        self._sleep(max(0.0, self._start + command.time - now))
        self._due = command.time + TARGET_PERIOD
        self._send(self._puppet.target(command.angles))

    def close(self) -> None:
        """Collect the last refusals and disconnect."""
        self._collect_refusals(timeout=TARGET_PERIOD)
        self._socket.close()

    def _send(self, target: ReachyTarget) -> None:
        try:
            self._socket.send(json.dumps(target.as_message()))
        except (OSError, WebSocketException) as error:
            raise ConfigError(f"{self._address}: the daemon of the Reachy Mini has gone: {error}") from None
        self.sent_count += 1
        self._collect_refusals(timeout=0.0)

    def _collect_refusals(self, *, timeout: float) -> None:
        """Read all messages that the daemon has sent."""
        try:
            while True:
                message = json.loads(self._socket.recv(timeout))
                self.refusals = [*self.refusals, str(message.get("detail", message))][-MAX_KEPT_REFUSALS:]
        except (TimeoutError, WebSocketException, ValueError):
            return

    def _approach(self, target: ReachyTarget) -> None:
        """Move to the first target and wait until the motion has ended."""
        message = target.as_message()
        goto = {
            "head_pose": message["target_head_pose"],
            "antennas": message["target_antennas"],
            "body_yaw": message["target_body_yaw"],
            "duration": APPROACH_DURATION,
        }
        self._post("move/goto", goto)
        self._sleep(APPROACH_DURATION)

    def _post(self, path: str, content: dict[str, object]) -> None:
        request = Request(
            f"{self._address}/api/{path}",
            data=json.dumps(content).encode(),
            headers={"Content-Type": "application/json"},
            method="POST",
        )
        try:
            with urlopen(request, timeout=REQUEST_TIMEOUT) as answer:
                answer.read()
        except (URLError, TimeoutError, OSError) as error:
            raise ConfigError(
                f"{self._address}: the daemon of the Reachy Mini refuses or does not answer {path}: {error}; "
                "start it (reachy-mini-daemon), and check the address"
            ) from None

    def _connect(self) -> ClientConnection:
        place = f"ws{self._address.removeprefix('http')}/api/move/ws/set_target"
        try:
            return connect(place, open_timeout=REQUEST_TIMEOUT, compression=None)
        except (OSError, WebSocketException) as error:
            raise ConfigError(f"{place}: the daemon of the Reachy Mini refuses the connection: {error}") from None


def _check_address(address: str) -> str:
    """Return an HTTP address without a slash at its end.

    Raises:
        ConfigError: the address is no HTTP address.
    """
    parts = urlsplit(address)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ConfigError(f"{address}: must be an HTTP address, such as {DEFAULT_ADDRESS}")
    return address.rstrip("/")
