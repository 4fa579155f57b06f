"""Faults as data (which, where, when, how often), and what they do to the bytes on a wire; a seed repeats a run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from random import Random
from typing import Literal, get_args

import msgspec

from kinesic.body.config import ConfigError, read_toml
from kinesic.hardware.protocol.registers import HardwareError
from kinesic.hardware.virtual.protocol import Sent

OfWire = Literal["corrupt", "drop", "truncate", "duplicate", "noise", "lost", "late"]
OfServo = Literal["silent", "reboot", "alert", "overheat", "undervoltage", "watchdog"]
OfBuild = Literal["duplicate_id", "wrong_model", "old_firmware"]
Kind = Literal[OfWire, OfServo, OfBuild, "unplug"]
Way = Literal["reply", "request"]

WIRE_KINDS, SERVO_KINDS, BUILD_KINDS = (frozenset(get_args(kinds)) for kinds in (OfWire, OfServo, OfBuild))
KINDS: tuple[str, ...] = get_args(Kind)
XL430 = 1060

DEFAULTS: Mapping[str, float] = {
    "late": 0.012,  # [s]
    "noise": 8,  # [bytes] at most
    "reboot": 0.13,  # [s] without power
    "alert": HardwareError.OVERLOAD.value,  # bits
    "overheat": 2.0,  # [K/s]
    "undervoltage": 9.0,  # [V]
    "duplicate_id": 0,  # number of the second servo's model; 0: the same
    "wrong_model": XL430,
    "old_firmware": 41,
}
"""What a fault's `value` means, and what it is if not given."""


@dataclass(frozen=True)
class PlannedFault:
    """One thing that goes wrong.

    Faults of the wire strike each answer, or each request, between `start` and its end with the chance `rate`, at one
    place of it; a servo's strike once, or last from start to end; those of the build are there from the beginning.
    """

    kind: Kind
    servos: tuple[int, ...] = ()  # ids; all if empty
    rate: float = 1.0  # 0..1, faults of the wire only
    start: float = 0.0  # [s]
    seconds: float = inf  # how long
    value: float | None = None  # see DEFAULTS
    way: Way = "reply"  # what is struck, faults of the wire only

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"fault {self.kind} is none; there are {', '.join(KINDS)}")
        if not 0.0 <= self.rate <= 1.0:
            raise ValueError(f"fault {self.kind}: rate is {self.rate}, must be within 0..1")
        if self.rate != 1.0 and self.kind not in WIRE_KINDS:
            raise ValueError(f"fault {self.kind} has no rate; give it a start")
        if not (self.start >= 0.0 and self.seconds > 0.0):
            raise ValueError(f"fault {self.kind}: start is {self.start} s for {self.seconds} s, must be >= 0 and > 0")
        if self.value is not None and self.kind not in DEFAULTS:
            raise ValueError(f"fault {self.kind} has no value; those with one are {', '.join(DEFAULTS)}")

    @property
    def end(self) -> float:
        """[s]."""
        return self.start + self.seconds

    @property
    def figure(self) -> float:
        """Its value, or the usual one."""
        return DEFAULTS.get(self.kind, 0.0) if self.value is None else self.value

    def strikes(self, servo: int, time: float) -> bool:
        """Returns whether it may concern a servo at a time [s]."""
        return self.start <= time < self.end and (not self.servos or servo in self.servos)


@dataclass(frozen=True)
class FaultPlan:
    """All that goes wrong on one wire."""

    faults: tuple[PlannedFault, ...] = ()
    seed: int = 0

    @classmethod
    def read(cls, path: Path) -> "FaultPlan":
        """Reads a TOML file: `seed`, and a `[[fault]]` for each fault.

        Raises:
            ConfigError: the file is missing or wrong.
        """
        found = read_toml(path, FaultFile)
        try:
            faults = tuple(table.fault() for table in found.fault)
        except ValueError as error:
            raise ConfigError(f"{path}: {error}") from None
        return cls(faults, found.seed)

    def of(self, kinds: frozenset[str]) -> tuple[PlannedFault, ...]:
        """Selects the faults of some kinds."""
        return tuple(fault for fault in self.faults if fault.kind in kinds)


CALM = FaultPlan()


class FaultTable(msgspec.Struct, forbid_unknown_fields=True):
    """[[fault]]."""

    kind: Kind
    servos: list[int] = []
    rate: float = 1.0
    start: float = 0.0
    seconds: float | None = None
    value: float | None = None
    way: Way = "reply"

    def fault(self) -> PlannedFault:
        """Returns the fault that it describes."""
        return PlannedFault(
            kind=self.kind,
            servos=tuple(self.servos),
            rate=self.rate,
            start=self.start,
            seconds=inf if self.seconds is None else self.seconds,
            value=self.value,
            way=self.way,
        )


class FaultFile(msgspec.Struct, forbid_unknown_fields=True):
    """A file of faults."""

    fault: list[FaultTable] = []
    seed: int = 0


@dataclass(frozen=True)
class Transmission:
    """What arrives of one transmission."""

    data: bytes
    delay: float  # [s] of silence before
    late: float = 0.0  # [s] that the host gets it later


class WireFaults:
    """Faults of one wire; the same seed and traffic meet the same faults."""

    def __init__(self, plan: FaultPlan, *, since: float = 0.0) -> None:
        """Faults begin to count.

        Args:
            plan: what goes wrong.
            since: [s] where the plan's times count from.
        """
        self._since = since
        faults = plan.of(WIRE_KINDS)
        self._on_replies = tuple(fault for fault in faults if fault.way == "reply")
        self._on_requests = tuple(fault for fault in faults if fault.way == "request")
        self._random = Random(plan.seed)

    def request(self, data: bytes, time: float) -> bytes:
        """Returns what the servos receive of what the host sends."""
        for fault in self._on_requests:
            if fault.start <= time - self._since < fault.end and self._random.random() < fault.rate:
                data = self._struck(fault, data)
        return data

    def replies(self, sent: Sequence[Sent], time: float) -> list[Transmission]:
        """Returns what the host receives of the answer to an instruction: one status or several, or a joint reply.

        A fault strikes one place of it. Who waits in vain for the bytes before his own keeps silent.
        """
        transmissions = [Transmission(answer.data, answer.delay) for answer in sent]
        end = len(sent)
        for fault in self._on_replies:
            struck = [k for k, answer in enumerate(sent) if fault.strikes(answer.servo, time - self._since)]
            if not struck or self._random.random() >= fault.rate:
                continue
            if fault.kind == "late":
                k = struck[0]
                transmissions[k] = replace(transmissions[k], late=transmissions[k].late + fault.figure)
                continue
            k = self._random.choice(struck)
            transmissions[k] = replace(transmissions[k], data=self._struck(fault, transmissions[k].data))
            if fault.kind == "lost" and sent[k].chained:
                end = min(end, k)
        return [part for part in transmissions[:end] if part.data]

    def _struck(self, fault: PlannedFault, data: bytes) -> bytes:
        dice = self._random
        if fault.kind == "noise":
            return dice.randbytes(dice.randint(1, max(1, int(fault.figure)))) + data
        if fault.kind == "duplicate":
            return data + data
        if fault.kind == "lost" or not data:
            return b""
        place = dice.randrange(len(data))
        if fault.kind == "truncate":
            return data[:place]
        changed = bytes((data[place] ^ dice.randint(1, 255),)) if fault.kind == "corrupt" else b""
        return data[:place] + changed + data[place + 1 :]
