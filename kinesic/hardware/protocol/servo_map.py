"""Assignment of servos to hinges, from a robot's `[[bus]]` tables.

The robot's calibration overrides zeros and directions.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import degrees
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.models import ALL_BAUD_RATES, MODELS_BY_NUMBER
from kinesic.hardware.protocol.packet import MAX_ID
from kinesic.hardware.protocol.ticks import Scale

BUS_NAME_PATTERN = re.compile(r"[A-Za-z0-9_-]{1,64}")  # valid names of buses, also used in file names
MID_TICKS = TICKS_PER_TURN // 2  # [ticks] middle of a turn, default servo position at hinge angle 0


class BusTable(msgspec.Struct, forbid_unknown_fields=True):
    """TOML table of one [[bus]] in a robot file."""

    name: str  # name for the option `--port NAME=PATH`
    baud: int  # [bit/s] baud rate
    ids: dict[str, int | list[int]]  # for each hinge: id of its servo, or ids of all servos on its shaft
    zero_ticks: dict[str, int] = {}  # [ticks] servo position at hinge angle 0; default 2048
    inverted: list[str] = []  # hinges whose servos turn in the opposite direction


class WiringFile(msgspec.Struct):
    """Schema of all [[bus]] tables in a robot file.

    `kinesic.body` reads the other tables.
    """

    bus: list[BusTable] = []


@dataclass(frozen=True)
class BusWiring:
    """Name and baud rate of a bus."""

    name: str
    baud: int  # [bit/s]


@dataclass(frozen=True)
class HingeServos:
    """Servos of one hinge, with zero position, direction and reduction.

    Those of a tandem have the same goal.
    """

    hinge: str
    bus: str
    ids: tuple[int, ...]
    zero_ticks: int = MID_TICKS  # [ticks] position at hinge angle 0
    inverted: bool = False  # whether servo and hinge rotate in opposite directions
    reduction: float = 1.0  # servo revolutions per hinge revolution


@dataclass(frozen=True)
class ServoMap:
    """All servos of a robot, by hinge."""

    buses: tuple[BusWiring, ...]
    servos: tuple[HingeServos, ...]  # one per hinge, in joint order

    @classmethod
    def of(cls, robot: Robot) -> "ServoMap":
        """Read the servo map from the robot's file.

        A robot without [[bus]] tables has an empty map.

        Raises:
            ConfigError: a hinge is unknown or has no servo, an id is out of range or used twice on a bus, a tandem
                has the wrong number of servos, or a hinge's range exceeds one servo turn.
        """
        tables = read_robot(robot.path, WiringFile).bus
        if not tables:
            return cls((), ())
        _check_buses(robot.path, tables)
        servos_by_hinge: dict[str, HingeServos] = {}
        bauds = {table.name: table.baud for table in tables}
        for servos in _servos(robot, tables):
            if servos.hinge in servos_by_hinge:
                buses = f"{servos_by_hinge[servos.hinge].bus} and {servos.bus}"
                raise ConfigError(f"{robot.path}: hinge {servos.hinge} is on the buses {buses}, must be on one")
            _check_servos(robot, servos)
            _check_baud(robot, servos, bauds[servos.bus])
            servos_by_hinge[servos.hinge] = servos
        missing = [name for name in robot.skeleton.names if name not in servos_by_hinge]
        if missing:
            raise ConfigError(f"{robot.path}: no servo id for {', '.join(missing)}; add them to [bus.ids]")
        return cls(
            buses=tuple(BusWiring(table.name, table.baud) for table in tables),
            servos=tuple(servos_by_hinge[name] for name in robot.skeleton.names),
        )

    @cached_property
    def scale(self) -> Scale:
        """Conversion between ticks and angles, in joint order."""
        return Scale(
            zeros=sealed([servos.zero_ticks for servos in self.servos]),
            turns=sealed([-s.reduction if s.inverted else s.reduction for s in self.servos]),
        )


def _servos(robot: Robot, tables: list[BusTable]) -> Iterator[HingeServos]:
    """Yield the servos of each hinge, in bus table order."""
    measured = robot.calibration
    reductions = dict(zip(robot.skeleton.names, (drive.reduction for drive in robot.drives), strict=True))
    for table in tables:
        for part, hinges in (("ids", table.ids), ("zero_ticks", table.zero_ticks), ("inverted", table.inverted)):
            valid_hinges = list(reductions) if part == "ids" else list(table.ids)
            for hinge in hinges:
                if hinge not in valid_hinges:
                    raise ConfigError(
                        f"{robot.path}: {part} of bus {table.name}: no {hinge}{suggestion(hinge, valid_hinges)}"
                    )
        for hinge, ids in table.ids.items():
            yield HingeServos(
                hinge=hinge,
                bus=table.name,
                ids=tuple(ids) if isinstance(ids, list) else (ids,),
                zero_ticks=measured.zero_ticks.get(hinge, table.zero_ticks.get(hinge, MID_TICKS)),
                inverted=measured.inverted.get(hinge, hinge in table.inverted),
                reduction=reductions[hinge],
            )


def _check_buses(path: Path, tables: list[BusTable]) -> None:
    names: set[str] = set()
    for table in tables:
        if table.name in names:
            raise ConfigError(f"{path}: bus {table.name} is described twice")
        names.add(table.name)
        if not BUS_NAME_PATTERN.fullmatch(table.name):
            raise ConfigError(
                f"{path}: bus {table.name!r} must consist of letters, digits, - and _, as it names its port"
            )
        if table.baud not in ALL_BAUD_RATES:
            rates = ", ".join(str(rate) for rate in ALL_BAUD_RATES)
            raise ConfigError(f"{path}: bus {table.name}: baud is {table.baud}, must be one of {rates}")
        owners: dict[int, str] = {}
        for hinge, ids in table.ids.items():
            for servo in ids if isinstance(ids, list) else [ids]:
                if servo in owners:
                    raise ConfigError(f"{path}: bus {table.name}: id {servo} is used by {owners[servo]} and {hinge}")
                owners[servo] = hinge


def _check_servos(robot: Robot, servos: HingeServos) -> None:
    """Refuse invalid ids, wrong tandem sizes, and ranges beyond one turn."""
    where = f"{robot.path}: bus {servos.bus}: {servos.hinge}"
    for servo in servos.ids:
        if not 0 <= servo <= MAX_ID:
            raise ConfigError(f"{where}: id is {servo}, outside 0..{MAX_ID}")
    joint = robot.skeleton.joint(servos.hinge)
    count = robot.drives[joint].count
    if len(servos.ids) != count:
        raise ConfigError(f"{where}: {len(servos.ids)} ids, but the hinge has count = {count}")
    hinge = robot.skeleton.hinges[joint]
    ends = ServoMap((), (servos,)).scale.ticks(np.array([[hinge.lower], [hinge.upper]])).ravel()
    if ends.min() < 0 or ends.max() >= TICKS_PER_TURN:
        turned = f"{degrees(hinge.lower):.0f}..{degrees(hinge.upper):.0f} deg is {ends.min()}..{ends.max()} ticks"
        raise ConfigError(f"{where}: {turned}, outside 0..{TICKS_PER_TURN - 1}; move zero_ticks")


def _check_baud(robot: Robot, servos: HingeServos, baud: int) -> None:
    """Refuse a baud rate that a servo's family does not have."""
    servo = robot.drives[robot.skeleton.joint(servos.hinge)].servo
    model = MODELS_BY_NUMBER.get(servo.model)
    if model is not None and baud not in model.bauds:
        rates = ", ".join(str(rate) for rate in sorted(model.bauds))
        raise ConfigError(
            f"{robot.path}: bus {servos.bus}: baud is {baud}, but {servo.name} of {servos.hinge} has {rates}"
        )


def load_robot(name: str | Path = "upper22") -> Robot:
    """Read a robot file and check its servo buses.

    Raises:
        ConfigError: the file is missing or invalid.
    """
    robot = Robot.load(name)
    ServoMap.of(robot)
    return robot
