"""Replies of one servo to the instructions of protocol 2.0."""

from dataclasses import dataclass, replace

from . import packet as p
from .firmware import Firmware
from .memory import Memory
from .packet import Packet
from .physics import Shaft
from .table import MODELS

BOOT_TIME = 0.25  # [s] time from a start until the servo receives instructions
RESET_ALL = 0xFF  # option of the factory reset: every register
RESET_ALL_BUT_ID = 0x01  # option of the factory reset: every register except the id
RESET_ALL_BUT_ID_AND_BAUD = 0x02  # option of the factory reset: every register except id and baud rate
CLEAR_KEY = bytes([0x44, 0x58, 0x4C, 0x22])  # parameters that an instruction CLEAR must have
BACKUP_KEY = b"CTRL"  # parameters that an instruction BACKUP must have
BAUD_RATES = (9600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000)
FIRST_UNUSED_ID = 253  # secondary ids from this value on are inactive


@dataclass(frozen=True)
class Answer:
    """Status reply before it is packed."""

    servo: int
    error: int
    parameters: bytes = b""


class Device:
    """Servo of the X series."""

    def __init__(
        self, servo: int, model: str, *, baud: int = 1_000_000, firmware: int = 52, angle: float = 0.0
    ) -> None:
        """Create a servo with id, baud rate and shaft angle [rad]."""
        self.memory = Memory(MODELS[model], servo, firmware)
        self.memory["baud"] = BAUD_RATES.index(baud)
        self.memory["return_delay"] = 0
        self.shaft = Shaft(MODELS[model], angle)
        self.firmware = Firmware(self.memory, self.shaft)
        self.mute = self.deaf = False
        self.wakes = 0.0  # [s] time from which on it receives instructions
        self._id_at = self.memory.item("id").address
        self._registered: tuple[int, bytes] | None = None
        self._backup: dict[str, int] | None = None

    @property
    def id(self) -> int:
        """Return the id that the servo obeys."""
        return self.memory.bytes[self._id_at]

    @property
    def baud(self) -> int:
        """Return the baud rate [bit/s] that the servo listens at."""
        return BAUD_RATES[self.memory["baud"]]

    @property
    def delay(self) -> float:
        """Return the delay [s] between an instruction and its reply."""
        return 2e-6 * self.memory["return_delay"]

    @property
    def fast(self) -> bool:
        """Return whether the firmware supports fast reads."""
        return self.memory["firmware"] >= self.memory.model.fast

    def awake(self, time: float) -> bool:
        """Whether the servo receives instructions."""
        return not self.deaf and time >= self.wakes

    def boot(self, time: float) -> None:
        """Restart the servo, which ignores instructions while it boots."""
        self._registered = None
        self.firmware.boot(time)
        self.wakes = time + BOOT_TIME

    def write(self, address: int, data: bytes, *, shadow: bool = False) -> int:
        """Write registers, run the firmware, and return an error number.

        A secondary id reaches RAM alone.
        """
        memory = self.memory
        names = memory.named(address, len(data))
        if shadow and any(memory.item(name).lasting for name in names):
            return p.ACCESS_ERROR
        before = {name: memory[name] for name in names}
        error = memory.write(address, data)
        if not error and "torque" in names and memory["torque"] and self.firmware.shut:
            memory["torque"] = 0  # torque returns only after a reboot
            return p.RESULT_FAIL
        if not error:
            self.firmware.switched(before)
        return error

    def show(self, address: int, size: int) -> tuple[int, bytes]:
        """Read registers as the servo reports them.

        Returns an error number and the bytes.
        """
        self.firmware.refresh()
        if not self.firmware.tampers:
            return self.memory.read(address, size)
        true = bytes(self.memory.bytes)
        for tamper in self.firmware.tampers:
            tamper(self.memory)
        result = self.memory.read(address, size)
        self.memory.bytes[:] = true
        return result

    def answer(self, error: int, parameters: bytes = b"") -> Answer:
        """Make a status reply, with the alert bit during a hardware error."""
        return Answer(self.id, error | (p.ALERT_BIT if self.memory["error"] else 0), parameters)

    def hear(self, packet: Packet, time: float) -> Answer | None:
        """Execute an instruction for one servo.

        None if the instruction is for another servo, or needs no reply.
        """
        own, everybody = packet.servo == self.id, packet.servo == p.BROADCAST_ID
        shadow = not own and packet.servo == self.memory["secondary_id"] < FIRST_UNUSED_ID
        if packet.intact:
            self.firmware.heard = time
        if not (own or everybody or shadow):
            return None
        if not packet.intact:
            return self.answer(p.CRC_ERROR) if own and self.memory["status_return"] == 2 else None
        level, me = self.memory["status_return"], self.id  # values before the instruction, which may change them
        answer = replace(self._do(packet, time, shadow), servo=me)
        least = {p.PING: 0, p.READ: 1}.get(packet.instruction, 2)
        if shadow or level < least or (everybody and packet.instruction != p.PING):
            return None
        return answer

    def _do(self, packet: Packet, time: float, shadow: bool) -> Answer:
        said, memory = packet.parameters, self.memory
        match packet.instruction:
            case p.PING:
                return self.answer(0 if not said else p.LENGTH_ERROR, memory.read(0, 2)[1] + memory.read(6, 1)[1])
            case p.READ if len(said) == 4:
                return self.answer(*self.show(_word(said, 0), _word(said, 2)))
            case p.WRITE if len(said) > 2:
                return self.answer(self.write(_word(said, 0), said[2:], shadow=shadow))
            case p.REG_WRITE if len(said) > 2:
                self._registered, memory["registered"] = (_word(said, 0), said[2:]), 1
                return self.answer(0)
            case p.ACTION if not said:
                return self.answer(self._act())
            case p.REBOOT if not said:
                answer = self.answer(0)
                self.boot(time)
                return answer
            case p.FACTORY_RESET if len(said) == 1:
                return self.answer(self._factory_reset(packet, time))
            case p.CLEAR if len(said) == 5:
                return self.answer(self._clear(said))
            case p.BACKUP if len(said) == 5:
                return self.answer(self._back_up(said, time))
            case p.READ | p.WRITE | p.REG_WRITE | p.ACTION | p.REBOOT | p.FACTORY_RESET | p.CLEAR | p.BACKUP:
                return self.answer(p.LENGTH_ERROR)
        return self.answer(p.INSTRUCTION_ERROR)

    def _act(self) -> int:
        if self._registered is None:
            return p.INSTRUCTION_ERROR
        address, data = self._registered
        self._registered, self.memory["registered"] = None, 0
        return self.write(address, data)

    def _factory_reset(self, packet: Packet, time: float) -> int:
        kept = {RESET_ALL: (), RESET_ALL_BUT_ID: ("id",), RESET_ALL_BUT_ID_AND_BAUD: ("id", "baud")}.get(
            packet.parameters[0]
        )
        if kept is None:
            return p.RANGE_ERROR
        if packet.servo == p.BROADCAST_ID and not kept:  # otherwise all servos would have the same id
            return p.RESULT_FAIL
        self.memory.reset(lasting=True, keep=kept)
        if "id" not in kept:
            self.memory["id"] = 1
        self.boot(time)
        return 0

    def _clear(self, said: bytes) -> int:
        """Reset the turn count of a servo at rest."""
        if said[0] != 1 or said[1:] != CLEAR_KEY:
            return p.RANGE_ERROR
        if abs(self.shaft.speed) > 0.01:
            return p.RESULT_FAIL
        self.firmware.fold()
        self.firmware.profile.stand(self.firmware.position)
        return 0

    def _back_up(self, said: bytes, time: float) -> int:
        memory = self.memory
        if said[0] not in (1, 2) or said[1:] != BACKUP_KEY:
            return p.RANGE_ERROR
        if memory["torque"] or (said[0] == 2 and self._backup is None):
            return p.RESULT_FAIL
        if said[0] == 1:
            self._backup, memory["backup_ready"] = memory.lasting(), 1
            return 0
        for name, value in (self._backup or {}).items():
            memory[name] = value
        self.boot(time)
        return 0


def _word(data: bytes, at: int) -> int:
    return int.from_bytes(data[at : at + 2], "little")
