"""Reaction of a virtual servo with Protocol 1.0 frames to instructions.

The servo is a Feetech servo or a Dynamixel servo of the AX or MX series. Electronics and shaft are those of the X
series' virtual servo; the family's table converts registers. Assumed without a source: a Feetech servo clamps goals to
its limits, and takes torque again after an overload when told so.
"""

from dataclasses import replace

from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.packet import Instruction
from kinesic.hardware.protocol.registers import RAM_START, Mode, Register
from kinesic.hardware.virtual.firmware import BOOT_TIME
from kinesic.hardware.virtual.servo import NEWEST_FIRMWARE, VirtualServo

ADDRESS_SPACE_SIZE = 256  # [bytes] size of the address space of a control table
RANGE_ERROR = 0x08  # bit of the error byte of Dynamixel servos: value out of range
INSTRUCTION_ERROR = 0x40  # bit of the error byte of Dynamixel servos: undefined instruction
SET_MIDDLE = 128  # Value of a Feetech torque switch that makes the present position the middle
MAX_HOMING_OFFSET = 2047  # [ticks] limit of a Feetech servo's homing offset


class FrameServo(VirtualServo):
    """Servo with Protocol 1.0 frames that answers as its manual describes."""

    def __init__(
        self,
        model: Model,
        *,
        servo: int = 1,
        baud: int = 1_000_000,
        firmware: int = NEWEST_FIRMWARE,
        latches_goal: bool = False,
    ) -> None:
        """Create a servo with factory settings, except for the given ones."""
        super().__init__(model, servo=servo, baud=baud, firmware=firmware, latches_goal=latches_goal)
        self.table = model.native_table
        self._spare = bytearray(ADDRESS_SPACE_SIZE)  # bytes of addresses without a register of the X series
        self._volatile: dict[Register, int] = {}  # locked EEPROM registers -> value after the next reboot
        self.memory[Register.OPERATING_MODE] = Mode.POSITION.value  # also of a family without such a register
        self._reset_ram()

    @property
    def alias(self) -> int | None:
        """Secondary id, which these families lack."""
        return None

    def answers(self, instruction: int) -> bool:
        """Return whether the status level permits a reply to an instruction."""
        level = self.memory[Register.STATUS_RETURN_LEVEL]
        if instruction == Instruction.PING or (self.table.maker == "Feetech" and instruction == Instruction.READ):
            return True
        return level > (instruction != Instruction.READ)

    def execute(self, instruction: int, parameters: bytes) -> tuple[int, bytes]:
        """Execute an instruction, and return error byte and data of the reply."""
        refusal, data = 0, b""
        if instruction == Instruction.READ and len(parameters) == 2:
            data = self.read(parameters[0], parameters[1])
        elif instruction == Instruction.WRITE and parameters:
            refusal = self.write_native(parameters[0], parameters[1:])
        elif instruction == Instruction.REG_WRITE and parameters:
            self._registered, self.memory[Register.REGISTERED_INSTRUCTION] = parameters, 1
        elif instruction == Instruction.ACTION:
            registered, self._registered = self._registered, None
            self.memory[Register.REGISTERED_INSTRUCTION] = 0
            refusal = self.write_native(registered[0], registered[1:]) if registered else 0
        elif instruction == Instruction.REBOOT:
            self.reboot()
        elif instruction != Instruction.PING:
            refusal = INSTRUCTION_ERROR
        own_error = refusal if self.table.maker == "Dynamixel" else 0
        return self.table.error_byte(self.memory[Register.HARDWARE_ERROR_STATUS]) | own_error, data

    def read(self, address: int, size: int) -> bytes:
        """Read a span of native addresses with current sensor values."""
        self.electronics.show()
        image = bytearray(self._spare)
        for register, field in self.table.fields.items():
            if field.address < address + size and field.end > address:
                image[field.address : field.end] = self.table.pack(register, self.memory[register])
        return bytes(image[address : address + size]).ljust(size, b"\0")

    def write_native(self, address: int, data: bytes) -> int:
        """Write bytes at a native address.

        Returns the error bits of refused values.
        """
        self._spare[address : address + len(data)] = data[: ADDRESS_SPACE_SIZE - address]
        refusal = 0
        for register, field in self.table.fields.items():
            if address <= field.address and field.end <= address + len(data) and register.field.writable:
                raw = data[field.address - address : field.end - address]
                refusal |= self._store(register, self.table.unpack(register, raw))
        self.electronics.changed()
        return refusal

    def reboot(self, *, seconds: float = BOOT_TIME) -> None:
        """Reboot the servo and restore registers written while the EEPROM was locked."""
        for register, value in self._volatile.items():
            self.memory[register] = value
        self._volatile.clear()
        self._reset_ram()
        super().reboot(seconds=seconds)

    def _reset_ram(self) -> None:
        self._spare[self.table.ram_start :] = bytes(ADDRESS_SPACE_SIZE - self.table.ram_start)
        if self.table.lock is not None:
            self._spare[self.table.lock] = 1

    def _store(self, register: Register, value: int) -> int:
        """Set a register and return the error bits of a refusal.

        The servo reacts to the new value.
        """
        memory, is_feetech = self.memory, self.table.maker == "Feetech"
        lowest, highest = memory[Register.MIN_POSITION_LIMIT], memory[Register.MAX_POSITION_LIMIT]
        if register is Register.GOAL_POSITION and not lowest <= value <= highest:
            if not is_feetech:
                return RANGE_ERROR
            value = min(max(value, lowest), highest)
        if register is Register.TORQUE_ENABLE:
            if is_feetech and value == SET_MIDDLE:
                self._set_middle()
                return 0
            if value and self.electronics.latched:
                if not is_feetech:
                    return 0
                self.electronics.latched, memory[Register.HARDWARE_ERROR_STATUS] = False, 0
            value = min(value, 1)
        self._note_persistence(register, value)
        memory[register] = value
        self._react(register)
        return 0

    def _note_persistence(self, register: Register, value: int) -> None:
        """Note whether a value of an EEPROM register survives a reboot."""
        table, memory = self.table, self.memory
        if table.fields[register].address >= table.ram_start:
            return
        is_locked = table.lock is not None and bool(self._spare[table.lock])
        if is_locked and register.field.address < RAM_START:
            self._volatile.setdefault(register, memory[register])
        elif not is_locked:
            self._volatile.pop(register, None)
            memory.model = replace(memory.model, initial={**memory.model.initial, register: value})

    def _set_middle(self) -> None:
        """Set the homing offset that makes the present position mid-turn."""
        memory, electronics = self.memory, self.electronics
        wanted = memory[Register.HOMING_OFFSET] + TICKS_PER_TURN // 2 - electronics.present_position()
        offset = (wanted + TICKS_PER_TURN // 2) % TICKS_PER_TURN - TICKS_PER_TURN // 2
        memory[Register.HOMING_OFFSET] = max(-MAX_HOMING_OFFSET, min(offset, MAX_HOMING_OFFSET))
        electronics.fold()
