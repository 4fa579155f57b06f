"""Gives servos their torque, and takes it: for whoever shows the token and confirms that nobody is in the way."""

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

LASTS = 30.0  # [s] that somebody may take to confirm
LETTERS = 8  # of a code, in bytes
LOOK = 0.02  # [s] between two looks at whether it is at rest
FOLDING = 10.0  # [s] that blocks may take to end before the servos fold by themselves
BUSY = "torque is being given or taken; wait for the answer to that"
NO_SERVOS = "this server drives no servos; start it with --on servos"


class ArmingClient(Protocol):
    """A client, as far as it asks for torque."""

    @property
    def number(self) -> int:
        """Which it is."""

    def send(self, message: str, /) -> None:
        """Tells it something."""


class MotionControl(Protocol):
    """Whoever performs, as far as torque is concerned."""

    @property
    def hindrance(self) -> str:
        """Why no servo may be armed now; empty if one may."""

    def interrupt(self, block: str | None) -> None:
        """Ends all blocks softly."""


@dataclass(frozen=True)
class _Challenge:
    """What a client was asked to confirm."""

    code: str
    until: float  # [s] of the machine's monotonic clock


class Arming:
    """Who may give servos their torque: a client that repeats in time, with the token, the code that it was told."""

    def __init__(self, loop: Loop, control: MotionControl) -> None:
        """Nobody has asked yet."""
        self._loop, self._control = loop, control
        self._challenges: dict[int, _Challenge] = {}  # by client
        self._task: Task[None] | None = None  # gives torque, or takes it

    def arm(self, client: ArmingClient, request: Arm, *, trusted: bool) -> None:
        """Asks a client to confirm, or arms the servos when it has; says why not, else.

        Args:
            client: whose request it is.
            request: with the code of the confirmation, or without.
            trusted: whether the token of this very message is right, or none is asked for.
        """
        servos, confirmed = self._loop.servos, self._take_confirmation(client.number, request.code)
        if not trusted:
            _refuse(client, request, "the token must come with this message: nobody else gives torque")
        elif servos is None:
            _refuse(client, request, NO_SERVOS)
        elif why := self._find_hindrance(servos):
            _refuse(client, request, why)
        elif request.code is None:
            code = token_hex(LETTERS)
            self._challenges[client.number] = _Challenge(code, monotonic() + LASTS)
            client.send(json_answer("confirm", id=request.id, code=code, servos=len(servos.members), lasts=LASTS))
        elif not confirmed:
            _refuse(client, request, f"not confirmed within {LASTS:.0f} s: send arm without code, and repeat its code")
        else:
            self._task = create_task(_answer(client, request, "armed", self._arm(servos)))

    def disarm(self, client: ArmingClient, request: Disarm) -> None:
        """Ends all blocks, folds, and takes the torque; whoever may connect may ask for it."""
        servos = self._loop.servos
        if servos is None:
            _refuse(client, request, NO_SERVOS)
        elif self._is_busy:
            _refuse(client, request, BUSY)
        else:
            self._control.interrupt(None)
            self._task = create_task(_answer(client, request, "disarmed", self._disarm(servos)))

    def close(self) -> None:
        """Begins nothing more."""
        if self._task is not None:
            self._task.cancel()

    @property
    def _is_busy(self) -> bool:
        return self._task is not None and not self._task.done()

    def _take_confirmation(self, number: int, code: str | None) -> bool:
        """Whether this is what a client was asked to repeat; it counts once, right or wrong."""
        now = monotonic()
        self._challenges = {each: asked for each, asked in self._challenges.items() if asked.until > now}
        asked = self._challenges.pop(number, None)
        return asked is not None and code is not None and compare_digest(asked.code.encode(), code.encode())

    def _find_hindrance(self, servos: ServoSink) -> str:
        """Says why no servo may be armed now; empty if all may."""
        if self._is_busy:
            return BUSY
        return "the servos have their torque already" if servos.armed else self._control.hindrance

    async def _arm(self, servos: ServoSink) -> None:
        if servos.state == "ended":
            await to_thread(servos.revive)
        self._loop.arm()
        while self._loop.is_alive() and not servos.armed:  # it does so at its next tick
            await sleep(LOOK)

    async def _disarm(self, servos: ServoSink) -> None:
        until = monotonic() + FOLDING
        while self._loop.is_alive() and not self._loop.settled() and monotonic() < until:
            await sleep(LOOK)
        await to_thread(servos.disarm)


async def _answer(client: ArmingClient, request: Arm | Disarm, done: str, deed: Awaitable[None]) -> None:
    """Does something, and tells the client that it is done, or why it is not."""
    try:
        await deed
    except BusError as error:
        _refuse(client, request, str(error))
    else:
        client.send(json_answer(done, id=request.id))


def _refuse(client: ArmingClient, request: Arm | Disarm, why: str) -> None:
    client.send(json_answer("refused", id=request.id, why=why))
