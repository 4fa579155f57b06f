"""What one cycle of a bus tells: the last record of every servo, how old it is, and what happened."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.bus.health import Name, Records
from kinesic.hardware.protocol.ticks import Ticks

Happening = Literal[
    "port lost",
    "port back",
    "silent",  # not heard for so long that the others no longer wait for it
    "heard",  # again
    "rebooted",  # it has forgotten its RAM; torque is off
    "error",  # its hardware error register has changed, to zero perhaps
    "watchdog",  # it has stopped because the bus was quiet
    "torque",  # switched on or off, by whoever
    "doubted",  # it said something surprising that it did not repeat
]


@dataclass(frozen=True)
class Event:
    """Something worth a line in the log."""

    time: float  # [s] on the wire's clock
    servo: int | None  # its id; None: the port
    kind: Happening
    text: str


@dataclass(frozen=True, eq=False)
class Cycle:
    """Servos stand in the order in which the bus was given them."""

    time: float  # [s] when it began, on the wire's clock
    duration: float  # [s]
    servos: tuple[int, ...]  # ids
    records: Records  # (n,) of dtype HEALTH and more: the last one believed, zeros before the first
    times: Floats  # (n,) [s] when it was taken; -inf: never
    fresh: Flags  # (n,) taken in this cycle
    late: Flags  # (n,) whose record of an earlier cycle has come in this one, dated by the servo's clock
    silent: Flags  # (n,) in quarantine
    lost: bool  # the port is gone
    signature: bytes  # of the records: while it stays, torque, errors, watchdogs and temperatures do
    events: tuple[Event, ...]

    @cached_property
    def ages(self) -> Floats:
        """(n,) [s] of the records at the end of the cycle; inf: never heard."""
        return self.time + self.duration - self.times

    def each(self, name: Name) -> Ticks:
        """(n,) one register of all servos, raw."""
        return self.records[name].astype(np.int64)

    @property
    def positions(self) -> Ticks:
        """(n,) PRESENT_POSITION [ticks]."""
        return self.each("position")
