"""Search for servos and survey of their registers."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import degrees, nan

import numpy as np

from kinesic.hardware.protocol.device import PingReply, RegisterChange, ServoAccess
from kinesic.hardware.protocol.frame_access import FrameAccess, open_access
from kinesic.hardware.protocol.models import ALL_BAUD_RATES
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.protocol.tables import FAMILY_TABLES, FamilyTable
from kinesic.hardware.protocol.ticks import Scale
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.preflight import RegisterTable, required_registers

PACKET_PROTOCOL = "Protocol 2.0"  # name of the protocol of the X series
FRAME_PROTOCOL = "Protocol 1.0"  # name of the protocol of older Dynamixel servos
FEETECH_PROTOCOL = "Feetech"  # name of the protocol of Feetech servos
USUAL_FRAME_IDS = range(21)  # ids that a quick scan pings one by one, because not all families answer a ping of all
FRAME_BAUD_RATES = frozenset(rate for table in FAMILY_TABLES.values() for rate in table.bauds.values())  # [bit/s]


@dataclass(frozen=True)
class FoundServo:
    """Servo that answered a scan, with its baud rate."""

    servo: PingReply
    baud: int  # [bit/s]
    shared: bool  # whether several servos seem to have this id
    protocol: str = PACKET_PROTOCOL


class CountingWire:
    """Wire that counts the received bytes."""

    def __init__(self, wire: Wire) -> None:
        self._wire, self.octets = wire, 0

    @property
    def name(self) -> str:
        """Path of the port."""
        return self._wire.name

    @property
    def baud(self) -> int:
        """Baud rate [bit/s]."""
        return self._wire.baud

    def now(self) -> float:
        """Return the wire's clock [s]."""
        return self._wire.now()

    def write(self, data: bytes | bytearray, /) -> None:
        """Send bytes."""
        self._wire.write(data)

    def read(self, deadline: float, /) -> bytes:
        """Wait for bytes until a deadline [s], and count them."""
        data = self._wire.read(deadline)
        self.octets += len(data)
        return data

    def sleep(self, until: float, /) -> None:
        """Wait until a time [s]."""
        self._wire.sleep(until)

    def reopen(self) -> bool:
        """Try once to reopen the port."""
        return self._wire.reopen()

    def close(self) -> None:
        """Close the port."""
        self._wire.close()


def scan_bus(
    opened: Callable[[int], Wire],
    *,
    bauds: Iterable[int] = ALL_BAUD_RATES,
    ids: Iterable[int] = (),
    step: Callable[[], None] = lambda: None,
    heard: dict[int, int] | None = None,
) -> tuple[FoundServo, ...]:
    """Search for servos of all families at several baud rates and ids.

    Args:
        opened: opens the port at a baud rate.
        bauds: [bit/s] rates to try.
        ids: ids to ping one by one, if they did not answer the ping to all.
        step: called after each baud rate.
        heard: filled with the number of received bytes by baud rate.

    Raises:
        BusError: the port does not open.
    """
    found_servos: list[FoundServo] = []
    for baud in bauds:
        wire = CountingWire(opened(baud))
        try:
            found_servos += _scan(ServoAccess(wire), ids, lambda servo: PACKET_PROTOCOL)
            if baud in FRAME_BAUD_RATES:
                found_servos += _scan(FrameAccess(wire, tries=1), ids or USUAL_FRAME_IDS, _frame_protocol)
        finally:
            wire.close()
        if heard is not None:
            heard[baud] = wire.octets
        step()
    return tuple(found_servos)


def _scan(access: ServoAccess, ids: Iterable[int], protocol: Callable[[PingReply], str]) -> list[FoundServo]:
    """Return the servos that answer in one protocol, sorted by id."""
    servos = {servo.id: servo for servo in access.ping_all()}
    for servo in ids:
        alone = access.ping(servo) if servo not in servos else None
        if alone is not None:
            servos[servo] = alone
    return [
        FoundServo(servo, access.wire.baud, access.is_shared(servo.id), protocol(servo))
        for _, servo in sorted(servos.items())
    ]


def _frame_protocol(servo: PingReply) -> str:
    """Return the protocol name of a servo with Protocol 1.0 frames."""
    table = servo.model.table if servo.model is not None else None
    return FEETECH_PROTOCOL if table is not None and table.maker == "Feetech" else FRAME_PROTOCOL


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
