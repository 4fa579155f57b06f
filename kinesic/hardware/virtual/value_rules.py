"""Which values a servo takes: the manual's ranges, the limits that other registers set, and what is locked when."""

from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, Mode, Register
from kinesic.hardware.virtual.control_table import Memory

TURNS_MAX = 1_048_575  # [ticks] of goals beyond one turn
TIME_PROFILE_FIRMWARE = 42
GOAL_TORQUE_FIRMWARE = 45  # drive mode's torque by goal update
REVERSE, FOLLOWER, BY_TIME, BY_GOAL = 1, 2, 4, 8  # bits of DRIVE_MODE

GOALS = frozenset({Register.GOAL_PWM, Register.GOAL_CURRENT, Register.GOAL_VELOCITY, Register.GOAL_POSITION})
_LIMITED = {
    Register.GOAL_PWM: Register.PWM_LIMIT,
    Register.GOAL_CURRENT: Register.CURRENT_LIMIT,
    Register.GOAL_VELOCITY: Register.VELOCITY_LIMIT,
}


def value_fault(memory: Memory, register: Register, value: int, *, latched: bool) -> Fault:
    """Why a value is not taken; NONE if it is.

    Args:
        memory: the servo's registers.
        register: to be written.
        value: asked.
        latched: the servo has shut down and waits for a reboot.
    """
    field = register.field
    if not field.writable or (field.eeprom and memory[Register.TORQUE_ENABLE]):
        return Fault.ACCESS
    if register in GOALS and memory[Register.BUS_WATCHDOG] == WATCHDOG_TRIPPED:
        return Fault.RANGE
    if register is Register.TORQUE_ENABLE and value and latched:
        return Fault.ACCESS
    if register is Register.GOAL_POSITION:
        return _goal_refusal(memory, value)
    lower, upper = memory.model.range(register)
    if not lower <= value <= upper or not _meant(memory, register, value):
        return Fault.RANGE
    limit = _LIMITED.get(register)
    return Fault.LIMIT if limit is not None and abs(value) > memory[limit] else Fault.NONE


def _goal_refusal(memory: Memory, value: int) -> Fault:
    """Within the limits in one turn, within 256 turns in the other modes."""
    if memory[Register.OPERATING_MODE] != Mode.POSITION.value:
        return Fault.NONE if abs(value) <= TURNS_MAX else Fault.RANGE
    inside = memory[Register.MIN_POSITION_LIMIT] <= value <= memory[Register.MAX_POSITION_LIMIT]
    return Fault.NONE if inside else Fault.LIMIT


def _meant(memory: Memory, register: Register, value: int) -> bool:
    """Whether a value inside the range is one of those that mean something."""
    model, firmware = memory.model, memory.firmware
    small = model.family == "330"
    if register is Register.OPERATING_MODE:
        return any(mode.value == value for mode in model.modes)
    if register is Register.DRIVE_MODE:
        known = REVERSE | (FOLLOWER if model.family == "540" else 0)
        known |= BY_TIME if small or firmware >= TIME_PROFILE_FIRMWARE else 0
        known |= BY_GOAL if firmware >= GOAL_TORQUE_FIRMWARE + small else 0
        return not value & ~known
    return True
