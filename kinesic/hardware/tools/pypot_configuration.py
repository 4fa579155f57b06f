"""Conversion of pypot's robot configurations to the calibration of a robot.

pypot adds an offset to the position of each motor and, for an indirect one, changes the sign. Its zeros are not those
of kinesic, so the difference from the configuration that the Poppy project publishes is applied to the robot's file.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import msgspec

from kinesic.body.calibration import Calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.servo_map import MID_TICKS, ServoMap

MAX_FILE_SIZE = 1_000_000  # [bytes] largest configuration file
MAX_OFFSET = 180.0  # [deg] largest offset of a motor


class PypotMotor(msgspec.Struct):
    """Configuration of one motor in a file of pypot."""

    id: int
    orientation: Literal["direct", "indirect"]
    offset: float  # [deg] added to the position before the sign changes


class _Configuration(msgspec.Struct):
    """Configuration file of pypot."""

    motors: dict[str, PypotMotor]


@dataclass(frozen=True)
class _Published:
    """Published offset [deg] and sign of a motor."""

    offset: float
    sign: int = 1  # -1: indirect


PUBLISHED_MOTORS: Mapping[str, Mapping[int, _Published]] = {  # robot -> servo id -> values of the Poppy project
    "poppy_torso": {
        33: _Published(0.0),
        34: _Published(0.0, -1),
        35: _Published(0.0, -1),
        36: _Published(0.0),
        37: _Published(-25.0, -1),
        41: _Published(90.0),
        42: _Published(-90.0, -1),
        43: _Published(0.0, -1),
        44: _Published(-90.0),
        51: _Published(90.0, -1),
        52: _Published(90.0, -1),
        53: _Published(0.0, -1),
        54: _Published(-90.0, -1),
    }
}


def read_pypot_motors(path: Path) -> dict[int, PypotMotor]:
    """Read a configuration file of pypot, by servo id.

    Raises:
        ConfigError: the file is missing, too large, or no configuration of pypot.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_FILE_SIZE + 1)
        if len(data) > MAX_FILE_SIZE:
            raise ConfigError(f"{path}: has more than {MAX_FILE_SIZE} bytes; a configuration has about 5000")
        motors = msgspec.json.decode(data, type=_Configuration).motors
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ConfigError(f"{path}: not a configuration of pypot: {error}") from None
    for name, motor in motors.items():
        if not abs(motor.offset) <= MAX_OFFSET:
            raise ConfigError(f"{path}: motor {name}: offset is {motor.offset:g} deg, must be -180 to 180")
    return {motor.id: motor for motor in motors.values()}


def convert_pypot(path: Path, robot: Robot, before: Calibration) -> Calibration:
    """Convert the configuration file of a Poppy robot.

    Args:
        path: configuration file of pypot.
        robot: robot without calibration, whose file agrees with the published configuration.
        before: previous calibration, whose ranges are kept.

    Raises:
        ConfigError: kinesic does not know the published configuration of the robot, or the file lacks a motor.
    """
    published = PUBLISHED_MOTORS.get(robot.name)
    if published is None:
        known = ", ".join(PUBLISHED_MOTORS)
        raise ConfigError(f"--pypot: {robot.name} is no robot of pypot that kinesic knows; known: {known}")
    motors = read_pypot_motors(path)
    zeros, inverted = dict[str, int](), dict[str, bool]()
    for wired in ServoMap.of(robot).servos:
        (id,) = wired.ids
        motor, standard = motors.get(id), published[id]
        if motor is None:
            raise ConfigError(f"{path}: no motor with id {id}, which {wired.hinge} has")
        sign = 1 if motor.orientation == "direct" else -1
        shift = sign * (motor.offset - standard.offset) * TICKS_PER_TURN / 360.0
        zeros[wired.hinge] = round(MID_TICKS + sign * standard.sign * (wired.zero_ticks - MID_TICKS) + shift)
        inverted[wired.hinge] = wired.inverted != (sign != standard.sign)
    return Calibration(
        robot=robot.name,
        zero_ticks=before.zero_ticks | zeros,
        inverted=before.inverted | inverted,
        range_deg=before.range_deg,
    )
