"""Reads which servo turns which hinge from the `[[bus]]` tables of a robot and its calibration, and checks it."""

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
from kinesic.hardware.protocol.registers import BAUD_RATES
from kinesic.hardware.protocol.ticks import Scale

MAX_ID = 252
NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")
MID_TICKS = TICKS_PER_TURN // 2


class BusTable(msgspec.Struct, forbid_unknown_fields=True):
    """[[bus]]."""

    name: str
    baud: int
    ids: dict[str, int | list[int]]
    zero_ticks: dict[str, int] = {}
    inverted: list[str] = []


class WiringFile(msgspec.Struct):
    """The part of a robot's file that tells about wires; the body reads the others."""

    bus: list[BusTable] = []


@dataclass(frozen=True)
class BusWiring:
    """One wire."""

    name: str
    baud: int  # [bit/s]


@dataclass(frozen=True)
class HingeServos:
    """The servos of one hinge; those of a tandem take the same goal."""

    hinge: str
    bus: str
    ids: tuple[int, ...]
    zero_ticks: int = MID_TICKS  # where the hinge's angle is 0
    inverted: bool = False  # the servo turns against the hinge
    reduction: float = 1.0  # servo turns per hinge turn


@dataclass(frozen=True)
class ServoMap:
    """All servos of a robot."""

    buses: tuple[BusWiring, ...]
    servos: tuple[HingeServos, ...]  # one per hinge, in joint order

    @classmethod
    def of(cls, robot: Robot) -> "ServoMap":
        """Reads the servo map from the robot's file; one without any [[bus]] has no servos on wires.

        Raises:
            ConfigError: a hinge is unknown or has no servo, an id is out of range or used twice on a bus, a tandem
                has the wrong number of servos, or a hinge's range leaves the servo's turn.
        """
        tables = read_robot(robot.path, WiringFile).bus
        if not tables:
            return cls((), ())
        _check_buses(robot.path, tables)
        found: dict[str, HingeServos] = {}
        for servos in _servos(robot, tables):
            if servos.hinge in found:
                buses = f"{found[servos.hinge].bus} and {servos.bus}"
                raise ConfigError(f"{robot.path}: hinge {servos.hinge} is on the buses {buses}, must be on one")
            _check_servos(robot, servos)
            found[servos.hinge] = servos
        missing = [name for name in robot.skeleton.names if name not in found]
        if missing:
            raise ConfigError(f"{robot.path}: no servo id for {', '.join(missing)}; add them to [bus.ids]")
        return cls(
            buses=tuple(BusWiring(table.name, table.baud) for table in tables),
            servos=tuple(found[name] for name in robot.skeleton.names),
        )

    @cached_property
    def scale(self) -> Scale:
        """Ticks against angles, in joint order."""
        return Scale(
            zeros=sealed([servos.zero_ticks for servos in self.servos]),
            turns=sealed([-s.reduction if s.inverted else s.reduction for s in self.servos]),
        )


def _servos(robot: Robot, tables: list[BusTable]) -> Iterator[HingeServos]:
    """One entry per named hinge, in the order of the file."""
    measured = robot.calibration
    reductions = dict(zip(robot.skeleton.names, (drive.reduction for drive in robot.drives), strict=True))
    for table in tables:
        for part, hinges in (("ids", table.ids), ("zero_ticks", table.zero_ticks), ("inverted", table.inverted)):
            known = list(reductions) if part == "ids" else list(table.ids)
            for hinge in hinges:
                if hinge not in known:
                    raise ConfigError(f"{robot.path}: {part} of bus {table.name}: no {hinge}{suggestion(hinge, known)}")
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
        if not NAME.fullmatch(table.name):
            raise ConfigError(f"{path}: bus {table.name!r} must be named by letters, digits, - and _, as its port is")
        if table.baud not in BAUD_RATES:
            rates = ", ".join(str(rate) for rate in BAUD_RATES)
            raise ConfigError(f"{path}: bus {table.name}: baud is {table.baud}, must be one of {rates}")
        owners: dict[int, str] = {}
        for hinge, ids in table.ids.items():
            for servo in ids if isinstance(ids, list) else [ids]:
                if servo in owners:
                    raise ConfigError(f"{path}: bus {table.name}: id {servo} is used by {owners[servo]} and {hinge}")
                owners[servo] = hinge


def _check_servos(robot: Robot, servos: HingeServos) -> None:
    """Refuses ids that no servo has, tandems of another size, and ranges that one servo turn cannot hold."""
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


def load_robot(name: str | Path = "upper22") -> Robot:
    """Reads a robot, and checks its buses too.

    Raises:
        ConfigError: the file is missing or wrong.
    """
    robot = Robot.load(name)
    ServoMap.of(robot)
    return robot
