"""Zeros, directions and limits measured on one robot's servos, laid over its file by names of hinges."""

import os
from pathlib import Path

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml, suggestion
from kinesic.body.robot_schema import HingeTable

SUFFIX = ".calibration.toml"


class Calibration(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Figures that `kinesic servos calibrate` measured. A hinge that it does not name is as the robot's file says."""

    robot: str = ""  # whose; empty: nobody's
    zero_ticks: dict[str, int] = {}  # where the servo stands when the hinge's angle is 0
    inverted: dict[str, bool] = {}  # whether the servo turns against the hinge
    range_deg: dict[str, tuple[float, float]] = {}  # how far the hinge really goes, where that is less than its range

    @property
    def hinges(self) -> frozenset[str]:
        """Names of all hinges that were measured."""
        return frozenset(self.zero_ticks) | frozenset(self.inverted) | frozenset(self.range_deg)


NONE = Calibration()


def calibration_path(robot: Path) -> Path:
    """Finds a robot's calibration: beside its file; of a robot of this package, in the user's own folder."""
    name = robot.stem + SUFFIX
    if robot.resolve().is_relative_to(CONFIGS):
        return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "kinesic" / name
    return robot.with_name(name)


def read_calibration(robot: Path, name: str) -> Calibration:
    """Reads the calibration of a robot; `NONE` if there is no file.

    Args:
        robot: path of the robot's file.
        name: of the robot.

    Raises:
        ConfigError: the file is wrong, or another robot's.
    """
    path = calibration_path(robot)
    if not path.exists():
        return NONE
    if not path.is_file():
        raise ConfigError(f"{path}: no ordinary file; remove or rename it")
    found = read_toml(path, Calibration)
    if found.robot != name:
        raise ConfigError(f"{path}: calibrates {found.robot or 'no robot'}, but stands for {name}; remove or rename it")
    return found


def narrow_ranges(hinges: list[HingeTable], calibration: Calibration, path: Path) -> list[HingeTable]:
    """Narrows the ranges of hinges to those that were measured.

    Raises:
        ConfigError: the calibration names a hinge that is not there, or a range beyond the robot's.
    """
    where, known = calibration_path(path), [hinge.name for hinge in hinges]
    for name in sorted(calibration.hinges - set(known)):
        raise ConfigError(f"{where}: no hinge {name}{suggestion(name, known)}")
    found = []
    for hinge in hinges:
        (lower, upper), (least, most) = calibration.range_deg.get(hinge.name, hinge.range_deg), hinge.range_deg
        if not least <= lower < upper <= most:
            raise ConfigError(f"{where}: range_deg of {hinge.name} is [{lower}, {upper}], outside [{least}, {most}]")
        found.append(msgspec.structs.replace(hinge, range_deg=(lower, upper)))
    return found
