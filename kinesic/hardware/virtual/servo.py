"""Reaction of a virtual X series servo to instructions.

Assumed without a source: a goal from before torque is switched on still counts, unless `latches_goal`; after a shutdown
torque is refused as a result error.
"""

from typing import NamedTuple

from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.packet import MAX_ID, Fault, Instruction
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.virtual.control_table import (
    GOAL_REGISTERS,
    TORQUE_BY_GOAL_BIT,
    Memory,
    RefusalError,
    RegisterWrite,
    value_fault,
)
from kinesic.hardware.virtual.firmware import BOOT_TIME, Firmware

NEWEST_FIRMWARE = 52  # Default firmware version of a virtual servo
CLEAR_FIRMWARE = 42  # First firmware with the CLEAR instruction
_CLEAR_TURNS = bytes((0x01, 0x44, 0x58, 0x4C, 0x22))  # Parameters of CLEAR that reset the turn count
_STORE_BACKUP = bytes((1, 0x43, 0x54, 0x52, 0x4C))  # Parameters of BACKUP that store RAM
_RESTORE_BACKUP = bytes((2, 0x43, 0x54, 0x52, 0x4C))  # Parameters of BACKUP that restore RAM
_KEPT_REGISTERS: dict[bytes, tuple[Register, ...]] = {  # registers that a factory reset keeps, by its option byte
    b"\xff": (),
    b"\x01": (Register.ID,),
    b"\x02": (Register.ID, Register.BAUD_RATE),
}
_MODE_REGISTERS = (  # registers that a change of operating mode resets
    Register.VELOCITY_I_GAIN,
    Register.VELOCITY_P_GAIN,
    Register.POSITION_D_GAIN,
    Register.POSITION_I_GAIN,
    Register.POSITION_P_GAIN,
    Register.FEEDFORWARD_2ND_GAIN,
    Register.FEEDFORWARD_1ST_GAIN,
    Register.PROFILE_ACCELERATION,
    Register.PROFILE_VELOCITY,
)


class Station(NamedTuple):
    """Baud rate and ids under which a servo receives."""

    baud: int  # [bit/s]
    id: int
    alias: int | None  # secondary id


class VirtualServo:
    """Servo that answers instructions as the manual describes."""

    def __init__(
        self,
        model: Model,
        *,
        servo: int = 1,
        baud: int = 57_600,
        firmware: int = NEWEST_FIRMWARE,
        latches_goal: bool = False,
    ) -> None:
        """Create a servo with factory settings, except for the given ones.

        Args:
            model: servo model.
            servo: id.
            baud: [bit/s].
            firmware: firmware version.
            latches_goal: whether switching torque on sets the goal to the present position; no source names the
                firmware that does, so the worse case is the default.
        """
        self.memory = Memory(model, firmware)
        self.memory[Register.ID] = servo
        self.memory[Register.BAUD_RATE] = model.baud_code(baud)
        self.electronics = Firmware(self.memory)
        self.mute = False  # whether the servo receives without answering
        self._latches_goal = latches_goal
        self._registered: bytes | None = None  # parameters of a registered write
        self._station, self._station_version = Station(0, 0, None), -1  # as read from this version of the EEPROM

    @property
    def id(self) -> int:
        """Id of the servo."""
        return self.memory[Register.ID]

    @property
    def alias(self) -> int | None:
        """Secondary id, obeyed without reply.

        None without one.
        """
        alias = self.memory[Register.SECONDARY_ID]
        return alias if alias <= MAX_ID and alias != self.id else None

    @property
    def baud(self) -> int:
        """Baud rate [bit/s]."""
        return self.memory.model.baud_rate(self.memory[Register.BAUD_RATE])

    @property
    def station(self) -> "Station":
        """Baud rate and ids under which the servo receives."""
        version = self.memory.eeprom_version
        if version != self._station_version:
            self._station, self._station_version = Station(self.baud, self.id, self.alias), version
        return self._station

    @property
    def delay(self) -> float:
        """Delay between an instruction and the servo's reply [s]."""
        return self.memory[Register.RETURN_DELAY_TIME] * Register.RETURN_DELAY_TIME.field.scale

    @property
    def fast(self) -> bool:
        """Whether the servo's firmware supports fast reads."""
        return self.memory.firmware >= self.memory.model.fast_firmware

    def answers(self, instruction: int) -> bool:
        """Return whether STATUS_RETURN_LEVEL permits a reply to an instruction."""
        if instruction == Instruction.PING:
            return True
        return self.memory[Register.STATUS_RETURN_LEVEL] > (instruction != Instruction.READ)

    def execute(self, instruction: int, parameters: bytes) -> tuple[int, bytes]:
        """Execute an instruction unless the servo refuses it.

        Returns:
            Error byte and data of the reply.
        """
        try:
            data = self._done(instruction, parameters)
        except RefusalError as refused:
            return refused.fault | self.electronics.alert, b""
        return self.electronics.alert, data

    def read(self, address: int, size: int) -> bytes:
        """Read a span of registers with current sensor values.

        Raises:
            RefusalError: the span has no registers.
        """
        self.electronics.show()
        return self.memory.read(address, size)

    def write(self, address: int, data: bytes) -> None:
        """Write registers, all or none.

        Raises:
            RefusalError: an address, a size or a value is invalid.
        """
        entries = self._checked(address, data)
        for entry in entries:
            self.memory.store(entry)
        for entry in entries:
            if entry.register is not None:
                self._react(entry.register)
        self.electronics.changed()

    def _checked(self, address: int, data: bytes) -> list[RegisterWrite]:
        memory, latched = self.memory, self.electronics.latched
        entries = memory.entries(address, data)
        for entry in entries:
            if entry.register is None:
                fault = Fault.NONE if memory.is_valid_pointer(entry) else Fault.RANGE
            else:
                value = int.from_bytes(entry.data, "little", signed=entry.register.field.signed)
                fault = value_fault(memory, entry.register, value, latched=latched)
            if fault:
                raise RefusalError(fault)
        return entries

    def _done(self, instruction: int, parameters: bytes) -> bytes:
        memory = self.memory
        if instruction == Instruction.PING:
            return memory.read(0, 2) + bytes((memory[Register.FIRMWARE_VERSION],))
        if instruction == Instruction.READ:
            if len(parameters) != 4:
                raise RefusalError(Fault.LENGTH)
            return self.read(int.from_bytes(parameters[:2], "little"), int.from_bytes(parameters[2:], "little"))
        if instruction == Instruction.WRITE:
            self.write(int.from_bytes(parameters[:2], "little"), parameters[2:])
        elif instruction == Instruction.REG_WRITE:
            self._checked(int.from_bytes(parameters[:2], "little"), parameters[2:])
            self._registered, memory[Register.REGISTERED_INSTRUCTION] = parameters, 1
        elif instruction == Instruction.ACTION:
            self._act()
        elif instruction == Instruction.REBOOT:
            self.reboot()
        elif instruction == Instruction.CLEAR and memory.firmware >= CLEAR_FIRMWARE:
            self._clear(parameters)
        elif instruction == Instruction.FACTORY_RESET:
            self._reset(parameters)
        elif instruction == Instruction.BACKUP and Register.STARTUP_CONFIGURATION in memory:
            self._keep(parameters)
        else:
            raise RefusalError(Fault.INSTRUCTION)
        return b""

    def reboot(self, *, seconds: float = BOOT_TIME) -> None:
        """Reboot the servo, as after a short power failure."""
        self._registered = None
        self.electronics.reboot(seconds=seconds)

    def _act(self) -> None:
        registered, self._registered = self._registered, None
        self.memory[Register.REGISTERED_INSTRUCTION] = 0
        if registered is None:
            raise RefusalError(Fault.INSTRUCTION)
        self.write(int.from_bytes(registered[:2], "little"), registered[2:])

    def _clear(self, parameters: bytes) -> None:
        electronics = self.electronics
        electronics.show()
        if parameters != _CLEAR_TURNS:
            raise RefusalError(Fault.RANGE)
        if self.memory[Register.MOVING]:
            raise RefusalError(Fault.RESULT)
        electronics.motion.fold(electronics.shaft)
        electronics.changed()

    def _reset(self, parameters: bytes) -> None:
        kept = _KEPT_REGISTERS.get(parameters)
        if kept is None:
            raise RefusalError(Fault.RANGE)
        values = {register: self.memory[register] for register in kept}
        self.memory.restore_eeprom()
        for register, value in values.items():
            self.memory[register] = value
        self.electronics.backup = None
        self.reboot()

    def _keep(self, parameters: bytes) -> None:
        """Execute the BACKUP instruction: store or restore the RAM."""
        electronics, memory = self.electronics, self.memory
        if memory[Register.TORQUE_ENABLE]:
            raise RefusalError(Fault.RESULT)
        if parameters == _STORE_BACKUP:
            memory[Register.BACKUP_READY] = 1
            electronics.backup = memory.ram()
        elif parameters != _RESTORE_BACKUP:
            raise RefusalError(Fault.RANGE)
        elif electronics.backup is None:
            raise RefusalError(Fault.RESULT)
        else:
            memory.put_ram(electronics.backup)

    def _react(self, register: Register) -> None:
        memory, electronics = self.memory, self.electronics
        if register is Register.TORQUE_ENABLE:
            self._energise()
        elif register is Register.OPERATING_MODE:
            for reset in _MODE_REGISTERS:
                memory[reset] = memory.model.factory_value(reset)
            memory[Register.GOAL_PWM] = memory[Register.PWM_LIMIT]
            electronics.fold()
        elif register in (Register.DRIVE_MODE, Register.HOMING_OFFSET):
            electronics.fold()
        elif register in GOAL_REGISTERS:
            if (
                memory[Register.DRIVE_MODE] & TORQUE_BY_GOAL_BIT
                and not memory[Register.TORQUE_ENABLE]
                and not electronics.latched
            ):
                memory[Register.TORQUE_ENABLE] = 1
                electronics.motion.rest(electronics.shaft, electronics.time)
            if memory[Register.TORQUE_ENABLE]:
                electronics.motion.aim(electronics.time)

    def _energise(self) -> None:
        memory, electronics = self.memory, self.electronics
        electronics.fold()
        if memory[Register.TORQUE_ENABLE]:
            if self._latches_goal:
                memory[Register.GOAL_POSITION] = electronics.present_position()
            electronics.motion.aim(electronics.time)
