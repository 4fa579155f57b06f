"""Arming with stub servos, loop and clients."""

import asyncio
import json
from collections.abc import Callable, Coroutine

import pytest

from kinesic.hardware.protocol.wire import BusError
from kinesic.serve.sinks import arming
from kinesic.serve.sinks.arming import Arming
from kinesic.serve.wire.protocol import Arm, Disarm


class Client:
    def __init__(self, number: int = 1) -> None:
        self.number, self.told = number, list[dict]()

    def send(self, message: str, /) -> None:
        self.told.append(json.loads(message))

    @property
    def last(self) -> dict:
        return self.told[-1]


class Servos:
    members = ("one", "two", "three")

    def __init__(self) -> None:
        self.armed, self.state, self.done = False, "limp", list[str]()
        self.fault = ""

    def arm(self) -> None:
        self.armed = True

    def disarm(self) -> None:
        self.done.append("disarmed")
        if self.fault:
            raise BusError(self.fault)
        self.armed = False

    def revive(self) -> None:
        self.done.append("revived")


class LoopOfServos:
    """Stub loop that arms some polls after the request."""

    def __init__(self, servos: Servos | None) -> None:
        self.servos, self.alive, self.rests, self.ticks = servos, True, True, 3
        self.asked = 0

    def arm(self) -> None:
        self.asked += 1

    def is_alive(self) -> bool:
        return self.alive

    def is_settled(self) -> bool:
        return self.rests

    def pass_time(self) -> None:
        if self.asked and self.servos is not None:
            self.ticks -= 1
            if self.ticks <= 0:
                self.servos.arm()


class Control:
    def __init__(self) -> None:
        self.arming_obstacle, self.interrupted = "", list[str | None]()

    def interrupt(self, block: str | None) -> None:
        self.interrupted.append(block)


class Desk:
    """Arming procedure with all its stubs, in simulated time."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, servos: Servos | None) -> None:
        self.time, self.loop, self.control = 1000.0, LoopOfServos(servos), Control()
        self.arming = Arming(self.loop, self.control)
        really = asyncio.sleep

        async def sleep(seconds: float) -> None:
            self.time += seconds
            self.loop.pass_time()
            await really(0)

        monkeypatch.setattr(arming, "monotonic", lambda: self.time)
        monkeypatch.setattr(arming, "sleep", sleep)

    async def ask(self, client: Client, code: str | None = None, *, trusted: bool = True) -> dict:
        self.arming.arm(client, Arm(token=None, code=code, id=5), trusted=trusted)
        await self.finish()
        return client.last

    async def disarm(self, client: Client) -> dict:
        self.arming.disarm(client, Disarm(id=6))
        await self.finish()
        return client.last

    async def finish(self) -> None:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        await asyncio.gather(*others, return_exceptions=True)


Play = Callable[[Callable[[Desk, Servos], Coroutine]], None]
