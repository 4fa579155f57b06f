"""Finds servos on a wire, and reads how each is: what it says of itself, and which registers differ."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import degrees, nan

import numpy as np

from kinesic.hardware.protocol.device import Change, Cold, Found, demand_answers
from kinesic.hardware.protocol.registers import BAUD_RATES, HardwareError, Register
from kinesic.hardware.protocol.ticks import Scale
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.preflight import Table, required_registers


@dataclass(frozen=True)
class Sighting:
    """A servo, and where it was found."""

    servo: Found
    baud: int  # [bit/s]
    shared: bool  # several servos seem to have this id


def scan_bus(
    opened: Callable[[int], Wire],
    *,
    bauds: Iterable[int] = BAUD_RATES,
    ids: Iterable[int] = (),
    step: Callable[[], None] = lambda: None,
) -> tuple[Sighting, ...]:
    """Looks for servos at every id and baud rate.

    Args:
        opened: opens the port at a baud rate.
        bauds: [bit/s] to try.
        ids: to ask one by one as well, where nobody of this id answered all being asked.
        step: is called after each baud rate.

    Raises:
        BusError: the port does not open.
    """
    found: list[Sighting] = []
    for baud in bauds:
        wire = opened(baud)
        try:
            cold = Cold(wire)
            servos = {servo.id: servo for servo in cold.everyone()}
            for servo in ids:
                alone = cold.ping(servo) if servo not in servos else None
                if alone is not None:
                    servos[servo] = alone
            found += [Sighting(servo, baud, cold.is_shared(servo.id)) for _, servo in sorted(servos.items())]
        finally:
            wire.close()
        step()
    return tuple(found)


@dataclass(frozen=True)
class SurveyedServo:
    """One servo of a robot, as it was found."""

    member: Member
    found: str = ""  # its model; empty: it does not answer
    firmware: int = 0
    degrees: float = nan  # of its hinge
    celsius: int = 0
    volts: float = 0.0
    torque: bool = False
    errors: tuple[str, ...] = ()  # that it has shut down with, or is about to
    differs: tuple[Change, ...] = ()  # from what it will be set to

    @property
    def right(self) -> bool:
        """Whether it is of the model that must be there."""
        return self.found == self.member.model.name


def survey(manifest: Manifest, wires: Mapping[str, Wire]) -> tuple[SurveyedServo, ...]:
    """Reads the state of every servo, and changes nothing.

    Args:
        manifest: of the robot.
        wires: open ones, by the names of buses; servos of other buses are left out.

    Raises:
        BusError: a port is gone.
    """
    colds = {name: open_slow_access(wire) for name, wire in wires.items()}
    return tuple(_seen(colds[member.bus], member) for member in manifest.members if member.bus in colds)


def open_slow_access(wire: Wire) -> Cold:
    """Tells all servos to answer every instruction, and returns slow access (`Cold`) to them.

    Raises:
        BusError: the port is gone.
    """
    demand_answers(wire)
    return Cold(wire)


def _seen(cold: Cold, member: Member) -> SurveyedServo:
    try:
        found = cold.ping(member.id)
        if found is None:
            return SurveyedServo(member)
        if found.number != member.model.number:
            return SurveyedServo(member, found.name, found.firmware)
        table = Table.read(cold, member)
    except BusError:  # it fell silent meanwhile; the others are looked at all the same
        return SurveyedServo(member)
    wishes = {register: value for register, value in required_registers(table).items() if table[register] != value}
    return SurveyedServo(
        member=member,
        found=found.name,
        firmware=found.firmware,
        degrees=degrees(_angle(member, table[Register.PRESENT_POSITION])),
        celsius=table[Register.PRESENT_TEMPERATURE],
        volts=table[Register.PRESENT_INPUT_VOLTAGE] * Register.PRESENT_INPUT_VOLTAGE.field.scale,
        torque=bool(table[Register.TORQUE_ENABLE]),
        errors=HardwareError.names(table[Register.HARDWARE_ERROR_STATUS]),
        differs=tuple(Change(member.id, register, table[register], value) for register, value in wishes.items()),
    )


def _angle(member: Member, ticks: int) -> float:
    """[rad] of the hinge."""
    scale = Scale(np.array([member.zero]), np.array([member.turns]))
    return float(scale.angles(np.array([ticks]))[0])


def find_unexpected_servos(cold: Cold, expected: Sequence[int]) -> tuple[str, ...]:
    """Returns id and model of servos that answer and are not expected.

    Raises:
        BusError: the port is gone.
    """
    return tuple(f"{servo.id} ({servo.name})" for servo in cold.everyone() if servo.id not in expected)
