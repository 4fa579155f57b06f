"""Conversion of lerobot's calibration files to the calibration of a robot.

lerobot writes a homing offset into each servo, so that the middle of its range is at half a turn. kinesic sets these
offsets to zero and adds them to its own zeros instead.
"""

from collections.abc import Mapping
from math import ceil, degrees, floor
from pathlib import Path

import msgspec

from kinesic.body.calibration import Calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.models import MODELS_BY_NUMBER
from kinesic.hardware.protocol.servo_map import HingeServos, ServoMap

MAX_FILE_SIZE = 1_000_000  # [bytes] largest calibration file
RANGE_PRECISION = 10  # steps of a degree to which ranges are rounded inward


class LerobotMotor(msgspec.Struct):
    """Calibration of one motor in a file of lerobot."""

    id: int
    homing_offset: int  # [ticks] value of the servo's register
    range_min: int  # [ticks] lowest position with this offset
    range_max: int  # [ticks] highest position with this offset
    drive_mode: int = 0  # 1: the servo is mounted the other way round


def read_lerobot_motors(path: Path) -> dict[int, LerobotMotor]:
    """Read a calibration file of lerobot, by servo id.

    Raises:
        ConfigError: the file is missing, too large, or no calibration of lerobot.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_FILE_SIZE + 1)
        if len(data) > MAX_FILE_SIZE:
            raise ConfigError(f"{path}: has more than {MAX_FILE_SIZE} bytes; a calibration has about 1000")
        motors = msgspec.json.decode(data, type=dict[str, LerobotMotor])
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not a calibration of lerobot: {error}") from None
    return {motor.id: motor for motor in motors.values()}


def convert_lerobot(files: Mapping[str, Path], robot: Robot, before: Calibration) -> Calibration:
    """Convert the calibration files of a robot's buses.

    Args:
        files: bus -> calibration file of lerobot.
        robot: robot without calibration, whose file gives zeros and directions for a servo with its middle at 2048.
        before: previous calibration, which is kept for the other buses.

    Raises:
        ConfigError: a file lacks a servo, or a range exceeds one turn or excludes the rest posture.
    """
    motors = {bus: read_lerobot_motors(path) for bus, path in files.items()}
    servos = [wired for wired in ServoMap.of(robot).servos if wired.bus in files]
    zeros, inverted, ranges = dict[str, int](), dict[str, bool](), dict[str, tuple[float, float]]()
    for wired in servos:
        motor = motors[wired.bus].get(wired.ids[0])
        if motor is None:
            raise ConfigError(f"{files[wired.bus]}: no motor with id {wired.ids[0]}, which {wired.hinge} has")
        offset = motor.homing_offset * _find_offset_sign(robot, wired)
        zeros[wired.hinge] = wired.zero_ticks + offset
        inverted[wired.hinge] = wired.inverted != bool(motor.drive_mode)
        ranges[wired.hinge] = _find_range(motor, wired, robot, files[wired.bus], inverted=inverted[wired.hinge])
    return Calibration(
        robot=robot.name,
        zero_ticks=before.zero_ticks | zeros,
        inverted=before.inverted | inverted,
        range_deg=before.range_deg | ranges,
    )


def _find_offset_sign(robot: Robot, wired: HingeServos) -> int:
    """Return the sign of the homing offset of a servo family.

    Feetech servos subtract the offset from their position, Dynamixel X servos add it.
    """
    model = MODELS_BY_NUMBER.get(robot.drives[robot.skeleton.joint(wired.hinge)].servo.model)
    return 1 if model is not None and model.table is not None else -1


def _find_range(
    motor: LerobotMotor, wired: HingeServos, robot: Robot, path: Path, *, inverted: bool
) -> tuple[float, float]:
    """Return the measured range [deg] within that of the robot's file."""
    per_degree = wired.reduction * (-1.0 if inverted else 1.0) * TICKS_PER_TURN / 360.0
    low, high = sorted((ticks - wired.zero_ticks) / per_degree for ticks in (motor.range_min, motor.range_max))
    hinge = robot.skeleton.hinges[robot.skeleton.joint(wired.hinge)]
    limits = [round(degrees(angle), 6) for angle in (hinge.lower, hinge.upper)]
    lower = max(ceil(low * RANGE_PRECISION) / RANGE_PRECISION, limits[0])
    upper = min(floor(high * RANGE_PRECISION) / RANGE_PRECISION, limits[1])
    rest = degrees(hinge.rest)
    if not lower <= rest <= upper:
        raise ConfigError(
            f"{path}: servo {motor.id} lets {wired.hinge} go {lower:g}..{upper:g} deg, which excludes its rest of "
            f"{rest:.0f} deg; calibrate it again over its whole range, or build it as the robot's page shows"
        )
    return lower, upper
