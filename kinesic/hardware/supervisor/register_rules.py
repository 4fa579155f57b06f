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
        "refused", Register.MODEL_NUMBER, detail="a different model", why="ranges, gains and units depend on the model"
    ),
    _rule("left", Register.MODEL_INFORMATION, why="the register is read-only and contains no information"),
    _rule("refused", Register.FIRMWARE_VERSION, detail="below 38", why="older versions have no bus watchdog"),
    _rule(
        "refused",
        Register.ID,
        detail="missing, or shared",
        why="two servos with one id move together, and their replies collide",
    ),
    _rule(
        "left", Register.BAUD_RATE, Register.PROTOCOL_TYPE, why="a servo that answers uses the same values as kinesic"
    ),
    _rule("set", Register.RETURN_DELAY_TIME, detail="0", why="any other value delays every reply"),
    _rule(
        "set",
        Register.DRIVE_MODE,
        detail="0",
        why="this disables reverse mode, slave mode, time-based profiles and torque by a goal",
    ),
    _rule(
        "set",
        Register.OPERATING_MODE,
        detail="3",
        why="goals are positions; kinesic sets this register first, because it resets gains and profile",
    ),
    _rule(
        "set",
        Register.SECONDARY_ID,
        detail="255, on all servos before other registers",
        why="a servo with an alias obeys commands to another servo",
    ),
    _rule(
        "set",
        Register.HOMING_OFFSET,
        detail="0",
        why="kinesic applies the calibrated zeros itself; with torque on, an offset may move the servo",
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
    _rule("refused", Register.PWM_LIMIT, detail="below 73 %", why="plans need this power; with 0, an arm has no power"),
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
    _rule("set", Register.STARTUP_CONFIGURATION, detail="0", why="a servo has no torque and no old goals at power-on"),
    _rule(
        "set",
        Register.SHUTDOWN,
        detail="52",
        why="the servo shuts down on electrical shock, overload or overheating, but not on low voltage",
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
    _rule(
        "left",
        Register.REGISTERED_INSTRUCTION,
        why="only the instruction ACTION executes it, and kinesic never sends ACTION",
    ),
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
        detail="the model's gain",
        why="plans assume this stiffness",
    ),
    _rule(
        "set",
        Register.POSITION_I_GAIN,
        detail="0",
        why="an integral part winds up under load, which plans do not model",
    ),
    _rule(
        "set",
        Register.FEEDFORWARD_1ST_GAIN,
        Register.FEEDFORWARD_2ND_GAIN,
        detail="0",
        why="setpoints already contain the feed-forward; if it were applied twice, the servo would overshoot",
    ),
    _rule("driven", Register.BUS_WATCHDOG, why="the watchdog is on while torque is on"),
    _rule(
        "driven",
        Register.GOAL_PWM,
        why="kinesic ramps it from 10 % to PWM_LIMIT, or near people to its cap, when it switches torque on",
    ),
    _rule("left", Register.GOAL_CURRENT, Register.GOAL_VELOCITY, why="position mode does not use them"),
    _rule(
        "set",
        Register.PROFILE_ACCELERATION,
        detail="0",
        why="with a profile, the servo would brake at every goal of a stream",
    ),
    _rule(
        "set",
        Register.PROFILE_VELOCITY,
        detail="the no-load velocity, near people a cap",
        why="a late goal causes no jump",
    ),
    _rule(
        "driven",
        Register.GOAL_POSITION,
        why="kinesic writes the present position before it switches torque on, and then the motion",
    ),
    _rule(
        "driven",
        Register.REALTIME_TICK,
        Register.PRESENT_CURRENT,
        Register.PRESENT_VELOCITY,
        Register.PRESENT_POSITION,
        Register.PRESENT_INPUT_VOLTAGE,
        Register.PRESENT_TEMPERATURE,
        why="kinesic reads them in every cycle and accepts values within bounds",
    ),
    _rule(
        "left",
        Register.MOVING,
        Register.MOVING_STATUS,
        Register.PRESENT_PWM,
        Register.VELOCITY_TRAJECTORY,
        Register.POSITION_TRAJECTORY,
        why="these registers are read-only and not needed",
    ),
    _rule("left", Register.BACKUP_READY, why="only STARTUP_CONFIGURATION restores a backup, and it is 0"),
)

REGISTER_RULES = (*EEPROM_RULES, *RAM_RULES)  # rules of all registers
