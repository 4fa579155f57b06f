"""Says of every register what becomes of it before a servo moves, and why; docs/servos.md shows the same table.

One rule stands behind all: limits are narrowed, never widened. A limit that is too narrow for the plans is refused, as
somebody may have meant it.
"""

from dataclasses import dataclass
from typing import Literal

from kinesic.hardware.protocol.registers import Register

Deed = Literal[
    "refused",  # where it is wrong, nothing is energised
    "set",  # written, and read back before torque comes
    "narrowed",  # set where it is wider than it may be, refused where it is too narrow
    "driven",  # written and watched all the time
    "left",  # as it was found
]


@dataclass(frozen=True)
class RegisterRule:
    """What becomes of some registers."""

    registers: tuple[Register, ...]
    deed: Deed
    detail: str  # to what it is set, or when it is refused
    why: str


def _rule(deed: Deed, *registers: Register, detail: str = "", why: str) -> RegisterRule:
    return RegisterRule(registers, deed, detail, why)


EEPROM_RULES = (
    _rule(
        "refused", Register.MODEL_NUMBER, detail="another model", why="ranges, gains and units are those of the model"
    ),
    _rule("left", Register.MODEL_INFORMATION, why="cannot be written, and says nothing"),
    _rule("refused", Register.FIRMWARE_VERSION, detail="below 38", why="older ones have no bus watchdog"),
    _rule(
        "refused", Register.ID, detail="missing, or shared", why="two servos with one id move together and talk at once"
    ),
    _rule("left", Register.BAUD_RATE, Register.PROTOCOL_TYPE, why="who answers talks as we do"),
    _rule("set", Register.RETURN_DELAY_TIME, detail="0", why="each answer would wait for it"),
    _rule(
        "set", Register.DRIVE_MODE, detail="0", why="no reverse, no follower, no profile by time, no torque by a goal"
    ),
    _rule("set", Register.OPERATING_MODE, detail="3", why="goals are positions; first, as it resets gains and profile"),
    _rule("set", Register.SECONDARY_ID, detail="255, of all servos first", why="an alias obeys what another is told"),
    _rule(
        "set",
        Register.HOMING_OFFSET,
        detail="0",
        why="zeros are the host's; with torque on, an offset may move the servo",
    ),
    _rule(
        "set",
        Register.MOVING_THRESHOLD,
        Register.PWM_SLOPE,
        detail="factory value",
        why="plans know the servo as it is made",
    ),
    _rule(
        "narrowed",
        Register.TEMPERATURE_LIMIT,
        detail="factory value at most, 50 C at least",
        why="a servo guards itself",
    ),
    _rule(
        "narrowed",
        Register.MAX_VOLTAGE_LIMIT,
        Register.MIN_VOLTAGE_LIMIT,
        detail="factory values",
        why="the supply lies between",
    ),
    _rule("refused", Register.PWM_LIMIT, detail="below 73 %", why="plans use so much; 0 is an arm without power"),
    _rule(
        "refused", Register.CURRENT_LIMIT, detail="below half the factory value", why="time slows down near the limit"
    ),
    _rule("refused", Register.VELOCITY_LIMIT, detail="below 80 % of the speed without load", why="plans use so much"),
    _rule(
        "narrowed",
        Register.MAX_POSITION_LIMIT,
        Register.MIN_POSITION_LIMIT,
        detail="the hinge's range and 40 ticks",
        why="a servo refuses a goal beyond, whoever sends it",
    ),
    _rule(
        "left",
        Register.EXTERNAL_PORT_MODE_1,
        Register.EXTERNAL_PORT_MODE_2,
        Register.EXTERNAL_PORT_MODE_3,
        Register.EXTERNAL_PORT_DATA_1,
        Register.EXTERNAL_PORT_DATA_2,
        Register.EXTERNAL_PORT_DATA_3,
        why="what hangs there is not ours",
    ),
    _rule("set", Register.STARTUP_CONFIGURATION, detail="0", why="no torque and no old goals when power comes"),
    _rule(
        "set",
        Register.SHUTDOWN,
        detail="52",
        why="electrical shock, overload, overheating; not voltage, which moves dip",
    ),
)

RAM_RULES = (
    _rule("driven", Register.TORQUE_ENABLE, why="comes last; who has it already is taken over where it stands"),
    _rule("left", Register.LED, why="moves nothing"),
    _rule(
        "set", Register.STATUS_RETURN_LEVEL, detail="2, of all on the wire", why="who keeps silent cannot be checked"
    ),
    _rule("left", Register.REGISTERED_INSTRUCTION, why="only an ACTION performs it, which is never sent"),
    _rule("refused", Register.HARDWARE_ERROR_STATUS, detail="any", why="it has shut down; somebody must find out why"),
    _rule("left", Register.VELOCITY_I_GAIN, Register.VELOCITY_P_GAIN, why="position mode does not use them"),
    _rule(
        "set",
        Register.POSITION_P_GAIN,
        Register.POSITION_D_GAIN,
        detail="the model's",
        why="plans reckon with this stiffness",
    ),
    _rule("set", Register.POSITION_I_GAIN, detail="0", why="it winds up against a load, and no plan knows it"),
    _rule(
        "set",
        Register.FEEDFORWARD_1ST_GAIN,
        Register.FEEDFORWARD_2ND_GAIN,
        detail="0",
        why="goals lead already; twice overshoots",
    ),
    _rule("driven", Register.BUS_WATCHDOG, why="on as long as there is torque"),
    _rule("driven", Register.GOAL_PWM, why="from 10 % to PWM_LIMIT while torque comes"),
    _rule("left", Register.GOAL_CURRENT, Register.GOAL_VELOCITY, why="position mode does not use them"),
    _rule("set", Register.PROFILE_ACCELERATION, detail="0", why="it would brake at every goal of a stream"),
    _rule(
        "set", Register.PROFILE_VELOCITY, detail="the speed without load", why="a goal that comes late makes no leap"
    ),
    _rule("driven", Register.GOAL_POSITION, why="where the servo stands before torque comes, then the motion"),
    _rule(
        "driven",
        Register.REALTIME_TICK,
        Register.PRESENT_CURRENT,
        Register.PRESENT_VELOCITY,
        Register.PRESENT_POSITION,
        Register.PRESENT_INPUT_VOLTAGE,
        Register.PRESENT_TEMPERATURE,
        why="read in every cycle, and believed within bounds",
    ),
    _rule(
        "left",
        Register.MOVING,
        Register.MOVING_STATUS,
        Register.PRESENT_PWM,
        Register.VELOCITY_TRAJECTORY,
        Register.POSITION_TRAJECTORY,
        why="cannot be written, and is not asked for",
    ),
    _rule("left", Register.BACKUP_READY, why="a backup comes back by STARTUP_CONFIGURATION alone, which is 0"),
)

REGISTER_RULES = (*EEPROM_RULES, *RAM_RULES)
