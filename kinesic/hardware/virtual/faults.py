"""Fault plans for virtual servos and wires.

The seed makes a run repeatable.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Literal, get_args

import msgspec

from kinesic.body.config import ConfigError, read_toml
from kinesic.hardware.protocol.registers import HardwareError

if TYPE_CHECKING:  # The command line names the kinds of faults without loading virtual servos.
    from kinesic.hardware.virtual.protocol import Sent

WireFaultKind = Literal["corrupt", "drop", "truncate", "duplicate", "noise", "lost", "late"]
ServoFaultKind = Literal["silent", "reboot", "alert", "overheat", "undervoltage", "watchdog"]
BuildFaultKind = Literal["duplicate_id", "wrong_model", "old_firmware"]
FaultKind = Literal[WireFaultKind, ServoFaultKind, BuildFaultKind, "unplug"]
Direction = Literal["reply", "request"]

WIRE_KINDS = frozenset(get_args(WireFaultKind))  # Kinds of faults of bytes on the bus
SERVO_KINDS = frozenset(get_args(ServoFaultKind))  # Kinds of faults that a servo develops during operation
BUILD_KINDS = frozenset(get_args(BuildFaultKind))  # Kinds of faults that a servo has from its creation on
FAULT_KINDS: tuple[str, ...] = get_args(FaultKind)  # names of all kinds of faults
XL430_NUMBER = 1060  # Model number of the XL430

DEFAULT_VALUES: Mapping[str, float] = {
    "late": 0.012,  # [s] delay
    "noise": 8,  # [bytes] maximum length
    "reboot": 0.13,  # [s] without power
    "alert": HardwareError.OVERLOAD.value,  # error bits
    "overheat": 2.0,  # [K/s] heating rate
    "undervoltage": 9.0,  # [V] supply
    "duplicate_id": 0,  # model number of the second servo; 0: the same model
    "wrong_model": XL430_NUMBER,
    "old_firmware": 41,
}
"""Default `value` of each fault kind, with its unit."""


@dataclass(frozen=True)
class PlannedFault:
    """Fault with its kind, targets, time and rate.

    Wire faults affect each reply, or each request, between `start` and `end` with probability `rate`, at one place of
    it. Servo faults happen once, or last from start to end. Build faults exist from the beginning.
    """

    kind: FaultKind
    servos: tuple[int, ...] = ()  # ids; empty: all
    rate: float = 1.0  # probability 0..1, wire faults only
    start: float = 0.0  # [s]
    seconds: float = inf  # [s] duration
    value: float | None = None  # see DEFAULT_VALUES
    way: Direction = "reply"  # affected direction, wire faults only

    def __post_init__(self) -> None:
        if self.kind not in FAULT_KINDS:
            raise ValueError(f"unknown fault {self.kind}; there are {', '.join(FAULT_KINDS)}")
        if not 0.0 <= self.rate <= 1.0:
            raise ValueError(f"fault {self.kind}: rate is {self.rate}, must be within 0..1")
        if self.rate != 1.0 and self.kind not in WIRE_KINDS:
            raise ValueError(f"fault {self.kind} has no rate; give it a start")
        if not (self.start >= 0.0 and self.seconds > 0.0):
            raise ValueError(f"fault {self.kind}: start is {self.start} s for {self.seconds} s, must be >= 0 and > 0")
        if self.value is not None and self.kind not in DEFAULT_VALUES:
            raise ValueError(f"fault {self.kind} has no value; those with one are {', '.join(DEFAULT_VALUES)}")

    @property
    def end(self) -> float:
        """End time [s]."""
        return self.start + self.seconds

    @property
    def effective_value(self) -> float:
        """Parameter value of the fault, or the default of its kind."""
        return DEFAULT_VALUES.get(self.kind, 0.0) if self.value is None else self.value

    def affects(self, servo: int, time: float) -> bool:
        """Return whether the fault may affect a servo at a time [s]."""
        return self.start <= time < self.end and (not self.servos or servo in self.servos)


@dataclass(frozen=True)
class FaultPlan:
    """Planned faults of one wire and its servos, with a random seed."""

    faults: tuple[PlannedFault, ...] = ()
    seed: int = 0

    @classmethod
    def read(cls, path: Path) -> "FaultPlan":
        """Read a TOML file with `seed` and one `[[fault]]` per fault.

        Raises:
            ConfigError: the file is missing or invalid.
        """
        fault_file = read_toml(path, FaultFile)
        try:
            faults = tuple(table.fault() for table in fault_file.fault)
        except ValueError as error:
            raise ConfigError(f"{path}: {error}") from None
        return cls(faults, fault_file.seed)

    def of(self, kinds: frozenset[str]) -> tuple[PlannedFault, ...]:
        """Select the faults of given kinds."""
        return tuple(fault for fault in self.faults if fault.kind in kinds)


NO_FAULTS = FaultPlan()  # plan without any fault


class FaultTable(msgspec.Struct, forbid_unknown_fields=True):
    """TOML table of one [[fault]] in a fault file."""

    kind: FaultKind  # kind of the fault
    servos: list[int] = []  # ids of affected servos; empty: all
    rate: float = 1.0  # probability 0..1 per message, for wire faults only
    start: float = 0.0  # [s] start time
    seconds: float | None = None  # [s] duration; default: to the end
    value: float | None = None  # strength, in the unit that the table of kinds states
    way: Direction = "reply"  # affected direction, for wire faults only

    def fault(self) -> PlannedFault:
        """Convert the TOML table to a planned fault."""
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
    """TOML file of planned faults."""

    fault: list[FaultTable] = []  # one `[[fault]]` each
    seed: int = 0  # seed of random faults


@dataclass(frozen=True)
class Transmission:
    """Arriving bytes of a transmission, with their delays."""

    data: bytes
    delay: float  # [s] silence on the wire before the first byte
    late: float = 0.0  # [s] additional delay at the host


class WireFaults:
    """Injector of a wire's faults, repeatable for the same seed and traffic."""

    def __init__(self, plan: FaultPlan, *, since: float = 0.0) -> None:
        """Select the wire faults of a plan, for requests and for replies.

        Args:
            plan: the faults.
            since: [s] origin of the plan's times.
        """
        self._since = since
        faults = plan.of(WIRE_KINDS)
        self._on_replies = tuple(fault for fault in faults if fault.way == "reply")
        self._on_requests = tuple(fault for fault in faults if fault.way == "request")
        self._random = Random(plan.seed)

    def request(self, data: bytes, time: float) -> bytes:
        """Apply request faults to host bytes, and return the received bytes."""
        for fault in self._on_requests:
            if fault.start <= time - self._since < fault.end and self._random.random() < fault.rate:
                data = self._damaged(fault, data)
        return data

    def replies(self, sent: "Sequence[Sent]", time: float) -> list[Transmission]:
        """Apply reply faults, and return the transmissions that reach the host.

        The reply is one status, several, or a common reply. A fault affects one place of it. In a common reply, servos
        after a lost block stay silent.
        """
        transmissions = [Transmission(answer.data, answer.delay) for answer in sent]
        end = len(sent)
        for fault in self._on_replies:
            affected = [k for k, answer in enumerate(sent) if fault.affects(answer.servo, time - self._since)]
            if not affected or self._random.random() >= fault.rate:
                continue
            if fault.kind == "late":
                k = affected[0]
                transmissions[k] = replace(transmissions[k], late=transmissions[k].late + fault.effective_value)
                continue
            k = self._random.choice(affected)
            transmissions[k] = replace(transmissions[k], data=self._damaged(fault, transmissions[k].data))
            if fault.kind == "lost" and sent[k].chained:
                end = min(end, k)
        return [part for part in transmissions[:end] if part.data]

    def _damaged(self, fault: PlannedFault, data: bytes) -> bytes:
        random = self._random
        if fault.kind == "noise":
            return random.randbytes(random.randint(1, max(1, int(fault.effective_value)))) + data
        if fault.kind == "duplicate":
            return data + data
        if fault.kind == "lost" or not data:
            return b""
        place = random.randrange(len(data))
        if fault.kind == "truncate":
            return data[:place]
        changed = bytes((data[place] ^ random.randint(1, 255),)) if fault.kind == "corrupt" else b""
        return data[:place] + changed + data[place + 1 :]
