"""Enabling and disabling of servo torque by clients (arming, disarming).

Arming needs the token and a person's confirmation that the robot's workspace is clear.
"""

from asyncio import Task, create_task, sleep, to_thread
from collections.abc import Awaitable
from dataclasses import dataclass
from hmac import compare_digest
from secrets import token_hex
from time import monotonic
from typing import Protocol

from kinesic.hardware.protocol.wire import BusError
from kinesic.serve.loop import Loop
from kinesic.serve.sinks.real_time import ServoSink
from kinesic.serve.wire.protocol import Arm, Disarm, json_answer

CONFIRMATION_TIMEOUT = 30.0  # [s] time limit for a person to confirm that torque may be enabled
CODE_SIZE = 8  # [bytes] random part of a confirmation code, sent as hexadecimal digits
ARMING_POLL_PERIOD = 0.02  # [s] between two checks of the servo state
BLOCK_END_TIMEOUT = 10.0  # [s] time limit for blocks to end before the servos fold
BUSY_REFUSAL = "a change of the torque is in progress; wait for its answer"  # reason during another request
NO_SERVOS_REFUSAL = "this server drives no servos; start it with --on servos"  # reason without servos


class ArmingClient(Protocol):
    """Client that requests to enable or disable the servo torque."""

    @property
    def number(self) -> int:
        """Number of the client."""

    def send(self, message: str, /) -> None:
        """Send a message to the client."""


class MotionControl(Protocol):
    """Interface to the running motion, as needed for arming."""

    @property
    def arming_obstacle(self) -> str:
        """Reason that prevents arming the servos, empty if none."""

    def interrupt(self, block: str | None) -> None:
        """End one block, or all blocks if None, with a smooth return."""


@dataclass(frozen=True)
class _Challenge:
    """Confirmation code sent to a client."""

    code: str
    until: float  # [s] monotonic clock time at which the code expires


class Arming:
    """Arming procedure with token and confirmation code.

    A client must repeat the code it received, within a time limit and with the token.
    """

    def __init__(self, loop: Loop, control: MotionControl) -> None:
        """Create an arming procedure without pending requests."""
        self._loop, self._control = loop, control
        self._challenges: dict[int, _Challenge] = {}  # by client
        self._task: Task[None] | None = None  # current change of the torque

    def arm(self, client: ArmingClient, request: Arm, *, trusted: bool) -> None:
        """Send a confirmation code, arm after its confirmation, or refuse.

        Args:
            client: sender of the request.
            request: arm message, with the confirmation code or without.
            trusted: whether this message contained the correct token, or none is required.
        """
        servos, confirmed = self._loop.servos, self._take_confirmation(client.number, request.code)
        if not trusted:
            _refuse(client, request, "this message must contain the token")
        elif servos is None:
            _refuse(client, request, NO_SERVOS_REFUSAL)
        elif obstacle := self._find_arming_obstacle(servos):
            _refuse(client, request, obstacle)
        elif request.code is None:
            code = token_hex(CODE_SIZE)
            self._challenges[client.number] = _Challenge(code, monotonic() + CONFIRMATION_TIMEOUT)
            client.send(
                json_answer("confirm", id=request.id, code=code, servos=len(servos.members), lasts=CONFIRMATION_TIMEOUT)
            )
        elif not confirmed:
            _refuse(
                client,
                request,
                f"not confirmed within {CONFIRMATION_TIMEOUT:.0f} s: send arm without a code, then with the new code",
            )
        else:
            self._task = create_task(_answer(client, request, "armed", self._arm(servos)))

    def disarm(self, client: ArmingClient, request: Disarm) -> None:
        """End all blocks, fold to rest and disable the torque.

        Any client that may connect may request this.
        """
        servos = self._loop.servos
        if servos is None:
            _refuse(client, request, NO_SERVOS_REFUSAL)
        elif self._is_busy:
            _refuse(client, request, BUSY_REFUSAL)
        else:
            self._control.interrupt(None)
            self._task = create_task(_answer(client, request, "disarmed", self._disarm(servos)))

    def close(self) -> None:
        """Cancel an unfinished change of the servo torque."""
        if self._task is not None:
            self._task.cancel()

    @property
    def _is_busy(self) -> bool:
        return self._task is not None and not self._task.done()

    def _take_confirmation(self, number: int, code: str | None) -> bool:
        """Return whether a code is the client's pending confirmation code.

        Each code is valid once.

        Any attempt, right or wrong, removes the pending code.
        """
        now = monotonic()
        self._challenges = {client: code for client, code in self._challenges.items() if code.until > now}
        challenge = self._challenges.pop(number, None)
        return challenge is not None and code is not None and compare_digest(challenge.code.encode(), code.encode())

    def _find_arming_obstacle(self, servos: ServoSink) -> str:
        """Return the reason that prevents arming, empty if none."""
        if self._is_busy:
            return BUSY_REFUSAL
        return "the servos are armed already" if servos.armed else self._control.arming_obstacle

    async def _arm(self, servos: ServoSink) -> None:
        if servos.state == "ended":
            await to_thread(servos.revive)
        self._loop.arm()
        while self._loop.is_alive() and not servos.armed:  # the loop arms at its next tick
            await sleep(ARMING_POLL_PERIOD)

    async def _disarm(self, servos: ServoSink) -> None:
        until = monotonic() + BLOCK_END_TIMEOUT
        while self._loop.is_alive() and not self._loop.is_settled() and monotonic() < until:
            await sleep(ARMING_POLL_PERIOD)
        await to_thread(servos.disarm)


async def _answer(client: ArmingClient, request: Arm | Disarm, done: str, action: Awaitable[None]) -> None:
    """Await a torque change and report the outcome to the client."""
    try:
        await action
    except BusError as error:
        _refuse(client, request, str(error))
    else:
        client.send(json_answer(done, id=request.id))


def _refuse(client: ArmingClient, request: Arm | Disarm, why: str) -> None:
    client.send(json_answer("refused", id=request.id, why=why))
