"""Simulates what a servo of the X series does with instructions.

Assumed where no source says: a goal from before torque came on still counts, unless `latches_goal`; after a shutdown
torque is refused as an access error.
"""

from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.packet import Fault, Instruction
from kinesic.hardware.protocol.registers import BAUD_RATES, Register
from kinesic.hardware.virtual.control_table import BY_GOAL, GOALS, Memory, RefusalError, RegisterWrite, value_fault
from kinesic.hardware.virtual.firmware import BOOT, Firmware

LARGEST_ID = 252
NEWEST = 52  # firmware unless said otherwise
CLEAR_FIRMWARE = 42
_CLEAR_TURNS = bytes((0x01, 0x44, 0x58, 0x4C, 0x22))
_STORE, _RESTORE = (bytes((option, 0x43, 0x54, 0x52, 0x4C)) for option in (1, 2))
_KEPT: dict[bytes, tuple[Register, ...]] = {  # by option of the factory reset
    b"\xff": (),
    b"\x01": (Register.ID,),
    b"\x02": (Register.ID, Register.BAUD_RATE),
}
_OF_MODE = (  # what a change of mode resets
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


class VirtualServo:
    """A servo that answers instructions as the manual says."""

    def __init__(
        self, model: Model, *, servo: int = 1, baud: int = 57_600, firmware: int = NEWEST, latches_goal: bool = False
    ) -> None:
        """As it comes out of its box, but for what is given.

        Args:
            model: which.
            servo: its id.
            baud: [bit/s] that it talks.
            firmware: version.
            latches_goal: whether torque coming on sets the goal to where it is; nobody says of which firmware it is
                true, so that the worse is assumed.
        """
        self.memory = Memory(model, firmware)
        self.memory[Register.ID] = servo
        self.memory[Register.BAUD_RATE] = BAUD_RATES.index(baud)
        self.electronics = Firmware(self.memory)
        self.mute = False  # hears, but does not answer
        self._latches_goal = latches_goal
        self._registered: bytes | None = None  # parameters of a write that waits for its action

    @property
    def id(self) -> int:
        """ID."""
        return self.memory[Register.ID]

    @property
    def alias(self) -> int | None:
        """Its secondary id, which it obeys without an answer; None if it has none."""
        alias = self.memory[Register.SECONDARY_ID]
        return alias if alias <= LARGEST_ID and alias != self.id else None

    @property
    def baud(self) -> int:
        """[bit/s]."""
        return BAUD_RATES[self.memory[Register.BAUD_RATE]]

    @property
    def delay(self) -> float:
        """[s] that it waits before it answers."""
        return self.memory[Register.RETURN_DELAY_TIME] * Register.RETURN_DELAY_TIME.field.scale

    @property
    def fast(self) -> bool:
        """Whether its firmware knows the fast reads."""
        return self.memory.firmware >= self.memory.model.fast_firmware

    def answers(self, instruction: int) -> bool:
        """Returns whether the status return level lets it answer."""
        if instruction == Instruction.PING:
            return True
        return self.memory[Register.STATUS_RETURN_LEVEL] > (instruction != Instruction.READ)

    def execute(self, instruction: int, parameters: bytes) -> tuple[int, bytes]:
        """Executes an instruction.

        Returns:
            Error byte, and data of the answer.
        """
        try:
            data = self._done(instruction, parameters)
        except RefusalError as refused:
            return refused.fault | self.electronics.alert, b""
        return self.electronics.alert, data

    def read(self, address: int, size: int) -> bytes:
        """Reads the registers of a span, as they are now.

        Raises:
            RefusalError: there are none.
        """
        self.electronics.show()
        return self.memory.read(address, size)

    def write(self, address: int, data: bytes) -> None:
        """Changes registers, all or none.

        Raises:
            RefusalError: a place, a size or a value is wrong.
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

    def reboot(self, *, seconds: float = BOOT) -> None:
        """Reboots, as when its power fails for a moment."""
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
        kept = _KEPT.get(parameters)
        if kept is None:
            raise RefusalError(Fault.RANGE)
        values = {register: self.memory[register] for register in kept}
        self.memory.restore_eeprom()
        for register, value in values.items():
            self.memory[register] = value
        self.electronics.backup = None
        self.reboot()

    def _keep(self, parameters: bytes) -> None:
        """The backup of RAM: stored, or brought back."""
        electronics, memory = self.electronics, self.memory
        if memory[Register.TORQUE_ENABLE]:
            raise RefusalError(Fault.RESULT)
        if parameters == _STORE:
            memory[Register.BACKUP_READY] = 1
            electronics.backup = memory.ram()
        elif parameters != _RESTORE:
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
            for reset in _OF_MODE:
                memory[reset] = memory.model.starts(reset)
            memory[Register.GOAL_PWM] = memory[Register.PWM_LIMIT]
            electronics.fold()
        elif register in (Register.DRIVE_MODE, Register.HOMING_OFFSET):
            electronics.fold()
        elif register in GOALS:
            if memory[Register.DRIVE_MODE] & BY_GOAL and not memory[Register.TORQUE_ENABLE] and not electronics.latched:
                memory[Register.TORQUE_ENABLE] = 1
                electronics.motion.rest(electronics.shaft, electronics.time)
            if memory[Register.TORQUE_ENABLE]:
                electronics.motion.aim(electronics.time)

    def _energise(self) -> None:
        memory, electronics = self.memory, self.electronics
        electronics.fold()
        if memory[Register.TORQUE_ENABLE]:
            if self._latches_goal:
                memory[Register.GOAL_POSITION] = electronics.here()
            electronics.motion.aim(electronics.time)
