"""Finds, reads and sets servos one by one, with all the time it takes, through dynamixel-sdk (see `sdk`)."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from dynamixel_sdk import COMM_SUCCESS

from kinesic.hardware.protocol.models import BY_NUMBER, Model
from kinesic.hardware.protocol.packet import ALERT, BROADCAST, Fault, write_packet
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.sdk import Packets, WirePort
from kinesic.hardware.protocol.wire import BusError, Wire

TRIES = 4
ANSWERS_ALL = 2  # STATUS_RETURN_LEVEL
LOOKS = 3  # for a servo whose answers do not collide
_DIFFERENT = Register.REALTIME_TICK.field.address, 28  # what two servos hardly ever have in common

Attempt = Callable[[], tuple[*tuple[list[int], ...], int, int]]  # data if there are some, result, error byte


@dataclass(frozen=True)
class Found:
    """A servo that answered a ping."""

    id: int
    number: int  # MODEL_NUMBER
    firmware: int

    @property
    def model(self) -> Model | None:
        """Its model, if it is one of the X series."""
        return BY_NUMBER.get(self.number)

    @property
    def name(self) -> str:
        """Its model's name, or number."""
        return self.model.name if self.model is not None else f"model {self.number}"


@dataclass(frozen=True)
class Change:
    """A register that was set to another value."""

    servo: int
    register: Register
    before: int
    after: int


def demand_answers(wire: Wire) -> None:
    """Tells all servos on a wire to answer every instruction.

    Raises:
        BusError: the port is gone.
    """
    wire.write(write_packet(BROADCAST, Register.STATUS_RETURN_LEVEL.field.address, bytes((ANSWERS_ALL,))))


class Cold:
    """Slow access to the servos of one wire, one by one, with retries; for anything but the cycle."""

    def __init__(self, wire: Wire, *, tries: int = TRIES) -> None:
        """Asks over a wire; each question is put `tries` times at most."""
        self.wire, self._tries = wire, tries
        self._port, self._packets = WirePort(wire), Packets()

    def everyone(self) -> tuple[Found, ...]:
        """Returns who answers a ping to all, by id; of servos with the same id only those whose answers agree."""
        answers, _ = self._packets.broadcastPing(self._port)
        return tuple(Found(servo, number, firmware) for servo, (number, firmware) in sorted(answers.items()))

    def ping(self, servo: int) -> Found | None:
        """Pings one servo; None if it does not answer."""
        for _ in range(TRIES):
            number, result, _ = self._packets.ping(self._port, servo)
            if result == COMM_SUCCESS:
                return Found(servo, number, self.read(servo, Register.FIRMWARE_VERSION))
        return None

    def is_shared(self, servo: int) -> bool:
        """Whether several servos have this id: they answer a ping alike, but not a read of clocks and sensors."""
        for _ in range(LOOKS):
            try:
                self.read_span(servo, *_DIFFERENT)
            except BusError:
                continue
            return False
        return True

    def read(self, servo: int, register: Register) -> int:
        """Reads the raw value of a register.

        Raises:
            BusError: the servo does not answer, or has no such register.
        """
        return register.field.unpack(self.read_span(servo, register.field.address, register.field.size))

    def read_several(self, servo: int, registers: Collection[Register]) -> dict[Register, int]:
        """Reads the raw values of some registers at once, with all that lies between them.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        begin = min(register.field.address for register in registers)
        data = self.read_span(servo, begin, max(register.field.end for register in registers) - begin)
        return {r: r.field.unpack(data[r.field.address - begin : r.field.end - begin]) for r in registers}

    def write(self, servo: int, register: Register, value: int) -> None:
        """Sets a register to a raw value.

        Raises:
            BusError: the servo does not answer, or refuses.
            ValueError: the value does not fit into the register.
        """
        self.write_span(servo, register.field.address, register.field.pack(value), name=register.name)

    def read_span(self, servo: int, address: int, size: int) -> bytes:
        """Several registers at once.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        what = f"read of {size} bytes at {address}"
        (data,) = self._repeat(servo, what, lambda: self._packets.readTxRx(self._port, servo, address, size))
        return bytes(data)

    def write_span(self, servo: int, address: int, data: bytes, *, name: str = "") -> None:
        """Several registers at once.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        what = f"write of {name or f'{len(data)} bytes'} at {address}"
        octets = list(data)
        self._repeat(servo, what, lambda: self._packets.writeTxRx(self._port, servo, address, len(octets), octets))

    def reboot(self, servo: int) -> None:
        """Reboots a servo: the only way out of a shutdown.

        Raises:
            BusError: it does not answer.
        """
        self._repeat(servo, "reboot", lambda: self._packets.reboot(self._port, servo))

    def configure(self, servo: int, required: Mapping[Register, int]) -> tuple[Change, ...]:
        """Sets only what differs, and reads it back.

        Raises:
            BusError: a register of EEPROM differs while torque is on, or one does not take its value.
        """
        before = {register: self.read(servo, register) for register in required}
        changes = [Change(servo, r, before[r], value) for r, value in required.items() if before[r] != value]
        locked = [change.register.name for change in changes if change.register.field.eeprom]
        if locked and self.read(servo, Register.TORQUE_ENABLE):
            raise BusError(f"{self._who(servo)}: {', '.join(locked)} cannot be set while its torque is on; release it")
        for change in changes:
            self.write(servo, change.register, change.after)
            now = self.read(servo, change.register)
            if now != change.after:
                raise BusError(f"{self._who(servo)}: {change.register.name} is {now} after {change.after} was written")
        return tuple(changes)

    def _who(self, servo: int) -> str:
        return f"{self.wire.name}: servo {servo}"

    def _repeat(self, servo: int, what: str, attempt: Attempt) -> list[list[int]]:
        """Repeats an attempt until something comes; an alert is no failure."""
        result = COMM_SUCCESS
        for _ in range(self._tries):
            *data, result, error = attempt()
            fault = error & ~ALERT
            if fault:
                name = Fault(fault).name if fault in list(Fault) else str(fault)
                raise BusError(f"{self._who(servo)}: {what} refused ({name.lower()} error)")
            if result == COMM_SUCCESS:
                return data
            self._port.pass_late_answers()  # or they would answer the next question, of another register
        reason = self._packets.getTxRxResult(result).removeprefix("[TxRxResult] ").rstrip("!")
        raise BusError(
            f"{self._who(servo)}: {what}: {reason} in {self._tries} tries; is it powered, wired, at this baud rate?"
        )
