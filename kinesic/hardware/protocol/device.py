"""Slow access to single servos through dynamixel-sdk (see `sdk`)."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from dynamixel_sdk import COMM_SUCCESS

from kinesic.hardware.protocol.models import MODELS_BY_NUMBER, Model
from kinesic.hardware.protocol.packet import ALERT_BIT, BROADCAST_ID, Fault, write_packet
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.sdk import Packets, WirePort
from kinesic.hardware.protocol.wire import BusError, Wire

MAX_TRIES = 4  # Default number of attempts per instruction
REPLY_TO_ALL = 2  # Value of STATUS_RETURN_LEVEL at which a servo replies to every instruction
COLLISION_TRIES = 3  # number of damaged replies from which several servos are assumed to have the same id
TABLE_SIZE = Register.PRESENT_TEMPERATURE.field.end  # [bytes] size of the span that `read_table` returns
_VARYING_START = Register.REALTIME_TICK.field.address  # first address of a span that differs between any two servos
_VARYING_SIZE = 28  # [bytes] size of the clock and sensor registers, which differ between servos

Attempt = Callable[[], tuple[*tuple[list[int], ...], int, int]]  # data, if any, then result and error byte


@dataclass(frozen=True)
class PingReply:
    """Reply of a servo to a ping: id, model number and firmware."""

    id: int
    number: int  # model number, as in register MODEL_NUMBER
    firmware: int  # firmware version

    @property
    def model(self) -> Model | None:
        """Model of the servo, or None outside the X series."""
        return MODELS_BY_NUMBER.get(self.number)

    @property
    def name(self) -> str:
        """Name of the model, or its number."""
        return self.model.name if self.model is not None else f"model {self.number}"


@dataclass(frozen=True)
class RegisterChange:
    """Change of one register of a servo, with old and new value."""

    servo: int  # id of the servo
    register: Register
    before: int  # raw value before the change
    after: int  # raw value after the change


class ServoAccess:
    """Access to single servos of a wire with retries, between bus cycles.

    This class speaks Protocol 2.0; `FrameAccess` speaks Protocol 1.0.
    """

    def __init__(self, wire: Wire, *, tries: int = MAX_TRIES) -> None:
        """Use a wire, with at most `tries` attempts per instruction."""
        self.wire, self._tries = wire, tries
        self._port, self._packets = WirePort(wire), Packets()

    def enable_replies(self) -> None:
        """Make all servos on the wire answer every instruction.

        Raises:
            BusError: the port is gone.
        """
        address = Register.STATUS_RETURN_LEVEL.field.address
        self.wire.write(write_packet(BROADCAST_ID, address, bytes((REPLY_TO_ALL,))))

    def release_all(self) -> None:
        """Switch the torque of all servos on the wire off, without verification.

        Raises:
            BusError: the port is gone.
        """
        self.wire.write(write_packet(BROADCAST_ID, Register.TORQUE_ENABLE.field.address, b"\0"))

    def reboot(self, servo: int) -> None:
        """Restart a servo, which resets its RAM and switches its torque off.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        self._repeat(servo, "reboot", lambda: self._packets.reboot(self._port, servo))

    def read_table(self, servo: int) -> bytes:
        """Read the registers of a servo up to PRESENT_TEMPERATURE in one span.

        Raises:
            BusError: the servo does not answer.
        """
        return self.read_span(servo, 0, TABLE_SIZE)

    def ping_all(self) -> tuple[PingReply, ...]:
        """Ping all servos and return the replies, sorted by id.

        Servos with the same id appear only if their replies agree.
        """
        answers, _ = self._packets.broadcastPing(self._port)
        return tuple(PingReply(servo, number, firmware) for servo, (number, firmware) in sorted(answers.items()))

    def ping(self, servo: int) -> PingReply | None:
        """Ping one servo, and return its reply, or None if silent."""
        for _ in range(MAX_TRIES):
            number, result, _ = self._packets.ping(self._port, servo)
            if result == COMM_SUCCESS:
                return PingReply(servo, number, self.read(servo, Register.FIRMWARE_VERSION))
        return None

    def is_shared(self, servo: int) -> bool:
        """Return whether several servos have this id.

        They answer a ping alike, but not a read of clocks and sensors.
        """
        for _ in range(COLLISION_TRIES):
            try:
                self.read_span(servo, _VARYING_START, _VARYING_SIZE)
            except BusError:
                continue
            return False
        return True

    def read(self, servo: int, register: Register) -> int:
        """Read the raw value of a register.

        Raises:
            BusError: the servo does not answer, or lacks the register.
        """
        return register.field.unpack(self.read_span(servo, register.field.address, register.field.size))

    def read_several(self, servo: int, registers: Collection[Register]) -> dict[Register, int]:
        """Read the raw values of several registers in one span.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        begin = min(register.field.address for register in registers)
        data = self.read_span(servo, begin, max(register.field.end for register in registers) - begin)
        return {r: r.field.unpack(data[r.field.address - begin : r.field.end - begin]) for r in registers}

    def write(self, servo: int, register: Register, value: int) -> None:
        """Set a register to a raw value.

        Raises:
            BusError: the servo does not answer, or refuses.
            ValueError: the value does not fit into the register.
        """
        self.write_span(servo, register.field.address, register.field.pack(value), name=register.name)

    def read_span(self, servo: int, address: int, size: int) -> bytes:
        """Read the bytes of consecutive registers.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        action = f"read of {size} bytes at {address}"
        (data,) = self._repeat(servo, action, lambda: self._packets.readTxRx(self._port, servo, address, size))
        return bytes(data)

    def write_span(self, servo: int, address: int, data: bytes, *, name: str = "") -> None:
        """Write the bytes of consecutive registers.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        action = f"write of {name or f'{len(data)} bytes'} at {address}"
        octets = list(data)
        self._repeat(servo, action, lambda: self._packets.writeTxRx(self._port, servo, address, len(octets), octets))

    def configure(self, servo: int, required: Mapping[Register, int]) -> tuple[RegisterChange, ...]:
        """Set the registers that differ, verify them, and return the changes.

        Raises:
            BusError: an EEPROM register differs while torque is on, or a register does not take its value.
        """
        before = {register: self.read(servo, register) for register in required}
        changes = [RegisterChange(servo, r, before[r], value) for r, value in required.items() if before[r] != value]
        locked = [change.register.name for change in changes if change.register.field.eeprom]
        if locked and self.read(servo, Register.TORQUE_ENABLE):
            raise BusError(
                f"{self._label(servo)}: {', '.join(locked)} cannot be set while its torque is on; release it"
            )
        for change in changes:
            self.write(servo, change.register, change.after)
            now = self.read(servo, change.register)
            if now != change.after:
                raise BusError(
                    f"{self._label(servo)}: {change.register.name} is {now} after {change.after} was written"
                )
        return tuple(changes)

    def _label(self, servo: int) -> str:
        return f"{self.wire.name}: servo {servo}"

    def _repeat(self, servo: int, action: str, attempt: Attempt) -> list[list[int]]:
        """Repeat an instruction until the servo replies, and return the data.

        An alert is not a failure.
        """
        result = COMM_SUCCESS
        for _ in range(self._tries):
            *data, result, error = attempt()
            fault = error & ~ALERT_BIT
            if fault:
                name = Fault(fault).name if fault in list(Fault) else str(fault)
                raise BusError(f"{self._label(servo)}: {action} refused ({name.lower()} error)")
            if result == COMM_SUCCESS:
                return data
            self._port.pass_late_answers()  # otherwise they would be taken as replies to the next instruction
        reason = self._packets.getTxRxResult(result).removeprefix("[TxRxResult] ").rstrip("!")
        raise BusError(
            f"{self._label(servo)}: {action}: {reason} in {self._tries} tries; is it powered, wired, at this baud rate?"
        )
