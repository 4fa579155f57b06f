"""Search for servos and survey of their registers."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import degrees, nan

import numpy as np

from kinesic.hardware.protocol.device import PingReply, RegisterChange, ServoAccess
from kinesic.hardware.protocol.frame_access import open_access
from kinesic.hardware.protocol.registers import BAUD_RATES, HardwareError, Register
from kinesic.hardware.protocol.tables import FamilyTable
from kinesic.hardware.protocol.ticks import Scale
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.preflight import RegisterTable, required_registers


@dataclass(frozen=True)
class FoundServo:
    """Servo that answered a scan, with its baud rate."""

    servo: PingReply
    baud: int  # [bit/s]
    shared: bool  # whether several servos seem to have this id


def scan_bus(
    opened: Callable[[int], Wire],
    *,
    bauds: Iterable[int] = BAUD_RATES,
    ids: Iterable[int] = (),
    step: Callable[[], None] = lambda: None,
) -> tuple[FoundServo, ...]:
    """Search for servos at several baud rates and ids.

    Args:
        opened: opens the port at a baud rate.
        bauds: [bit/s] rates to try.
        ids: ids to ping one by one, if they did not answer the ping to all.
        step: called after each baud rate.

    Raises:
        BusError: the port does not open.
    """
    found_servos: list[FoundServo] = []
    for baud in bauds:
        wire = opened(baud)
        try:
            access = ServoAccess(wire)
            servos = {servo.id: servo for servo in access.ping_all()}
            for servo in ids:
                alone = access.ping(servo) if servo not in servos else None
                if alone is not None:
                    servos[servo] = alone
            found_servos += [FoundServo(servo, baud, access.is_shared(servo.id)) for _, servo in sorted(servos.items())]
        finally:
            wire.close()
        step()
    return tuple(found_servos)


@dataclass(frozen=True)
class SurveyedServo:
    """State of one servo of a robot, as read by `survey`."""

    member: Member
    model_name: str = ""  # name of its model; empty: no answer
    firmware: int = 0
    degrees: float = nan  # [deg] angle of its hinge
    celsius: int = 0  # [C] temperature
    volts: float = 0.0  # [V] supply voltage
    torque: bool = False  # whether torque is on
    errors: tuple[str, ...] = ()  # active hardware errors
    differs: tuple[RegisterChange, ...] = ()  # registers that a start would change

    @property
    def right(self) -> bool:
        """Whether the servo is of the required model."""
        return self.model_name == self.member.model.name


def survey(manifest: Manifest, wires: Mapping[str, Wire]) -> tuple[SurveyedServo, ...]:
    """Read the state of every servo.

    Only STATUS_RETURN_LEVEL is written.

    Args:
        manifest: servos of the robot.
        wires: open wires, by bus name; servos on other buses are skipped.

    Raises:
        BusError: a port is gone.
    """
    accesses = {name: open_slow_access(wire, manifest.tables[name]) for name, wire in wires.items()}
    return tuple(_seen(accesses[member.bus], member) for member in manifest.members if member.bus in accesses)


def open_slow_access(wire: Wire, table: FamilyTable | None = None) -> ServoAccess:
    """Make servos answer all instructions, and return access with retries.

    Args:
        wire: an open wire.
        table: control table of the family on the wire; None: X series with Protocol 2.0.

    Raises:
        BusError: the port is gone.
    """
    access = open_access(wire, table)
    access.enable_replies()
    return access


def _seen(access: ServoAccess, member: Member) -> SurveyedServo:
    try:
        reply = access.ping(member.id)
        if reply is None:
            return SurveyedServo(member)
        if reply.number != member.model.number:
            return SurveyedServo(member, reply.name, reply.firmware)
        table = RegisterTable.read(access, member)
    except BusError:  # it became silent during the survey; the others are read all the same
        return SurveyedServo(member)
    changes = {register: value for register, value in required_registers(table).items() if table[register] != value}
    return SurveyedServo(
        member=member,
        model_name=reply.name,
        firmware=reply.firmware,
        degrees=degrees(_angle(member, table[Register.PRESENT_POSITION])),
        celsius=table[Register.PRESENT_TEMPERATURE],
        volts=table[Register.PRESENT_INPUT_VOLTAGE] * Register.PRESENT_INPUT_VOLTAGE.field.scale,
        torque=bool(table[Register.TORQUE_ENABLE]),
        errors=HardwareError.names(table[Register.HARDWARE_ERROR_STATUS]),
        differs=tuple(
            RegisterChange(member.id, register, table[register], value) for register, value in changes.items()
        ),
    )


def _angle(member: Member, ticks: int) -> float:
    """Convert ticks to the hinge's angle [rad]."""
    scale = Scale(np.array([member.zero]), np.array([member.turns]))
    return float(scale.angles(np.array([ticks]))[0])


def find_unexpected_servos(access: ServoAccess, expected: Sequence[int]) -> tuple[str, ...]:
    """Return id and model of answering servos that are not expected.

    Raises:
        BusError: the port is gone.
    """
    return tuple(f"{servo.id} ({servo.name})" for servo in access.ping_all() if servo.id not in expected)
