"""Rules for each register before torque is switched on, with the reason.

docs/reference/servos.md shows the same table. Limits are narrowed, never widened. A limit that is too narrow for
plans is refused, because it may be intended.
"""

from dataclasses import dataclass
from typing import Literal

from kinesic.hardware.protocol.registers import Register

Treatment = Literal[
    "refused",  # a wrong value prevents torque
    "set",  # written and read back before torque is switched on
    "narrowed",  # set if too wide, refused if too narrow
    "driven",  # written or read in operation
    "left",  # not changed
]


@dataclass(frozen=True)
class RegisterRule:
    """Treatment of a group of registers before a servo moves."""

    registers: tuple[Register, ...]
    treatment: Treatment
    detail: str  # new value of the registers, or the condition of refusal
    why: str


def _rule(treatment: Treatment, *registers: Register, detail: str = "", why: str) -> RegisterRule:
    return RegisterRule(registers, treatment, detail, why)


EEPROM_RULES = (
    _rule(
        "refused", Register.MODEL_NUMBER, detail="another model", why="ranges, gains and units are those of the model"
    ),
    _rule("left", Register.MODEL_INFORMATION, why="read-only, without information"),
    _rule("refused", Register.FIRMWARE_VERSION, detail="below 38", why="older ones have no bus watchdog"),
    _rule(
        "refused",
        Register.ID,
        detail="missing, or shared",
        why="two servos with one id move together, and their replies collide",
    ),
    _rule("left", Register.BAUD_RATE, Register.PROTOCOL_TYPE, why="a servo that answers uses the same ones"),
    _rule("set", Register.RETURN_DELAY_TIME, detail="0", why="it delays every reply"),
    _rule(
        "set",
        Register.DRIVE_MODE,
        detail="0",
        why="no reverse mode, no slave mode, no time-based profile, no torque by a goal",
    ),
    _rule(
        "set",
        Register.OPERATING_MODE,
        detail="3",
        why="goals are positions; set first, because it resets gains and profile",
    ),
    _rule(
        "set",
        Register.SECONDARY_ID,
        detail="255, of all servos first",
        why="a servo with an alias obeys commands to another servo",
    ),
    _rule(
        "set",
        Register.HOMING_OFFSET,
        detail="0",
        why="the host applies zeros; with torque on, an offset may move the servo",
    ),
    _rule(
        "set",
        Register.MOVING_THRESHOLD,
        Register.PWM_SLOPE,
        detail="factory value",
        why="plans assume the servo's factory values",
    ),
    _rule(
        "narrowed",
        Register.TEMPERATURE_LIMIT,
        detail="factory value at most, 50 C at least",
        why="the servo protects itself",
    ),
    _rule(
        "narrowed",
        Register.MAX_VOLTAGE_LIMIT,
        Register.MIN_VOLTAGE_LIMIT,
        detail="factory values",
        why="the supply voltage lies between them",
    ),
    _rule("refused", Register.PWM_LIMIT, detail="below 73 %", why="plans need this power; 0 is an arm without power"),
    _rule(
        "refused",
        Register.CURRENT_LIMIT,
        detail="below half the factory value",
        why="performance time slows down near the limit",
    ),
    _rule(
        "refused", Register.VELOCITY_LIMIT, detail="below 80 % of the no-load velocity", why="plans need this velocity"
    ),
    _rule(
        "narrowed",
        Register.MAX_POSITION_LIMIT,
        Register.MIN_POSITION_LIMIT,
        detail="the hinge's range and 40 ticks",
        why="the servo refuses goals beyond them from any sender",
    ),
    _rule(
        "left",
        Register.EXTERNAL_PORT_MODE_1,
        Register.EXTERNAL_PORT_MODE_2,
        Register.EXTERNAL_PORT_MODE_3,
        Register.EXTERNAL_PORT_DATA_1,
        Register.EXTERNAL_PORT_DATA_2,
        Register.EXTERNAL_PORT_DATA_3,
        why="connected devices are not part of the robot",
    ),
    _rule("set", Register.STARTUP_CONFIGURATION, detail="0", why="no torque and no old goals at power-on"),
    _rule(
        "set",
        Register.SHUTDOWN,
        detail="52",
        why="electrical shock, overload, overheating; not voltage, which drops in motion",
    ),
)

RAM_RULES = (
    _rule("driven", Register.TORQUE_ENABLE, why="switched on last; a servo with torque is taken over at its position"),
    _rule("left", Register.LED, why="has no effect on motion"),
    _rule(
        "set",
        Register.STATUS_RETURN_LEVEL,
        detail="2, on all servos of the wire",
        why="a silent servo cannot be checked",
    ),
    _rule("left", Register.REGISTERED_INSTRUCTION, why="only an ACTION executes it, which is never sent"),
    _rule(
        "refused",
        Register.HARDWARE_ERROR_STATUS,
        detail="any",
        why="the servo has shut down; a person must find the cause",
    ),
    _rule("left", Register.VELOCITY_I_GAIN, Register.VELOCITY_P_GAIN, why="position mode does not use them"),
    _rule(
        "set",
        Register.POSITION_P_GAIN,
        Register.POSITION_D_GAIN,
        detail="the model's",
        why="plans assume this stiffness",
    ),
    _rule("set", Register.POSITION_I_GAIN, detail="0", why="it winds up under load, which plans do not model"),
    _rule(
        "set",
        Register.FEEDFORWARD_1ST_GAIN,
        Register.FEEDFORWARD_2ND_GAIN,
        detail="0",
        why="setpoints already contain the feed-forward; applied twice, it overshoots",
    ),
    _rule("driven", Register.BUS_WATCHDOG, why="on while torque is on"),
    _rule("driven", Register.GOAL_PWM, why="ramped from 10 % to PWM_LIMIT when torque is switched on"),
    _rule("left", Register.GOAL_CURRENT, Register.GOAL_VELOCITY, why="position mode does not use them"),
    _rule("set", Register.PROFILE_ACCELERATION, detail="0", why="it would brake at every goal of a stream"),
    _rule("set", Register.PROFILE_VELOCITY, detail="the no-load velocity", why="a late goal causes no jump"),
    _rule("driven", Register.GOAL_POSITION, why="the present position before torque is switched on, then the motion"),
    _rule(
        "driven",
        Register.REALTIME_TICK,
        Register.PRESENT_CURRENT,
        Register.PRESENT_VELOCITY,
        Register.PRESENT_POSITION,
        Register.PRESENT_INPUT_VOLTAGE,
        Register.PRESENT_TEMPERATURE,
        why="read in every cycle, and accepted within bounds",
    ),
    _rule(
        "left",
        Register.MOVING,
        Register.MOVING_STATUS,
        Register.PRESENT_PWM,
        Register.VELOCITY_TRAJECTORY,
        Register.POSITION_TRAJECTORY,
        why="read-only, and not needed",
    ),
    _rule("left", Register.BACKUP_READY, why="a backup is restored by STARTUP_CONFIGURATION only, which is 0"),
)

REGISTER_RULES = (*EEPROM_RULES, *RAM_RULES)  # rules of all registers
