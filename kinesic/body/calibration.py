"""Measured servo zeros, directions and ranges, overriding a robot's file."""

import os
from pathlib import Path

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml, suggestion
from kinesic.body.robot_schema import HingeTable

CALIBRATION_SUFFIX = ".calibration.toml"  # end of the name of a calibration file


class Calibration(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Servo zeros, directions and ranges measured by `kinesic servos calibrate`, per hinge.

    A hinge without an entry keeps the values of the robot's file.
    """

    robot: str = ""  # name of the robot; empty: none
    zero_ticks: dict[str, int] = {}  # [ticks] servo position at hinge angle 0
    inverted: dict[str, bool] = {}  # whether servo and hinge rotate in opposite directions
    range_deg: dict[str, tuple[float, float]] = {}  # [deg] measured range, if it is smaller than the range in the file

    @property
    def hinges(self) -> frozenset[str]:
        """Names of all measured hinges."""
        return frozenset(self.zero_ticks) | frozenset(self.inverted) | frozenset(self.range_deg)


NO_CALIBRATION = Calibration()  # calibration without any measured value


def calibration_path(robot: Path) -> Path:
    """Return the path of a robot's calibration file.

    It lies next to the robot's file; for a robot of this package, in the user's configuration folder.
    """
    name = robot.stem + CALIBRATION_SUFFIX
    if robot.resolve().is_relative_to(CONFIGS):
        return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "kinesic" / name
    return robot.with_name(name)


def read_calibration(robot: Path, name: str) -> Calibration:
    """Read a robot's calibration file, or return `NO_CALIBRATION` if it is missing.

    Args:
        robot: path of the robot's file.
        name: name of the robot.

    Raises:
        ConfigError: the file is invalid, or calibrates another robot.
    """
    path = calibration_path(robot)
    if not path.exists():
        return NO_CALIBRATION
    if not path.is_file():
        raise ConfigError(f"{path}: not a regular file; remove or rename it")
    calibration = read_toml(path, Calibration)
    if calibration.robot != name:
        raise ConfigError(f"{path}: calibrates {calibration.robot or 'no robot'}, not {name}; remove or rename it")
    return calibration


def narrow_ranges(hinges: list[HingeTable], calibration: Calibration, path: Path) -> list[HingeTable]:
    """Narrow the ranges of hinges to the measured ranges.

    Raises:
        ConfigError: the calibration names an unknown hinge, or a range outside the robot's.
    """
    calibration_file, hinge_names = calibration_path(path), [hinge.name for hinge in hinges]
    for name in sorted(calibration.hinges - set(hinge_names)):
        raise ConfigError(f"{calibration_file}: no hinge {name}{suggestion(name, hinge_names)}")
    narrowed = []
    for hinge in hinges:
        (lower, upper), (min_deg, max_deg) = calibration.range_deg.get(hinge.name, hinge.range_deg), hinge.range_deg
        if not min_deg <= lower < upper <= max_deg:
            raise ConfigError(
                f"{calibration_file}: range_deg of {hinge.name} is [{lower}, {upper}], outside [{min_deg}, {max_deg}]"
            )
        narrowed.append(msgspec.structs.replace(hinge, range_deg=(lower, upper)))
    return narrowed
