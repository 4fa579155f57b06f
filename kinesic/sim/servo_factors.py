"""How far the real servos may be from their data sheets: the same robot, made weaker, heavier or later."""

import json
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, lru_cache
from math import inf
from pathlib import Path
from typing import Literal

import msgspec

from kinesic.body.config import ConfigError, read_toml, suggestion
from kinesic.body.robot import Robot
from kinesic.body.servo import ServoModel

MOST_PLAY = 0.2  # [rad] beyond which a gear is broken
MOST_RESISTANCE = 5.0  # [ohm] beyond which a supply feeds no servo


class DriveFactors(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Multipliers on the figures of a servo model; 1 leaves a figure as it is."""

    stall: float = 1.0
    no_load: float = 1.0
    friction: float = 1.0  # Coulomb and viscous
    armature: float = 1.0
    gain: float = 1.0  # duty per error: the position P gain over its divisor

    def __post_init__(self) -> None:
        """Refuses factors that are not positive.

        Raises:
            ValueError: names the factor and its value.
        """
        for name in DriveFactors.__struct_fields__:
            _positive(name, getattr(self, name))


class Factors(DriveFactors, frozen=True, forbid_unknown_fields=True):
    """Multipliers on a robot's figures, and what else may differ."""

    mass: float = 1.0  # of structure and servos
    supply: float = 1.0  # voltage: stall torque, stall current and no-load speed follow it
    resistance: float = (
        0.0  # [ohm] of the supply and its leads: the voltage falls by it times the current of all servos
    )
    amps: float = inf  # [A] that the supply gives at most: its voltage falls until the servos draw no more
    latency: float = 0.0  # [s] from a command until its goals reach the servos
    play: float = 0.0  # [rad] by which gears let each hinge turn freely; the servo measures the hinge
    servos: dict[str, DriveFactors] = {}  # of single servo models, in place of those above

    def __post_init__(self) -> None:
        """Refuses factors that are not positive, and latency, play and a supply that cannot be.

        Raises:
            ValueError: names the factor and its value.
        """
        super().__post_init__()
        _positive("mass", self.mass)
        _positive("supply", self.supply)
        if not 0.0 <= self.latency < 1.0:
            raise ValueError(f"latency is {self.latency} s, must be in [0, 1)")
        if not 0.0 <= self.play < MOST_PLAY:
            raise ValueError(f"play is {self.play} rad, must be in [0, {MOST_PLAY}): 0.0087 is half a degree")
        if not 0.0 <= self.resistance < MOST_RESISTANCE:
            raise ValueError(f"resistance is {self.resistance} ohm, must be in [0, {MOST_RESISTANCE}): 0.1 is usual")
        _positive("amps", self.amps)

    def __hash__(self) -> int:
        """Of the content, the table of servos included."""
        return hash(msgspec.json.encode(self))

    @classmethod
    def read(cls, path: Path) -> "Factors":
        """Reads factors from a TOML file; those not named leave their figure as it is.

        Raises:
            ConfigError: the file is missing or wrong.
        """
        return read_toml(path, cls)

    def text(self) -> str:
        """Writes what `read` reads; figures that are as in the data sheets are left out."""
        lines = _departures(self)
        for name, own in sorted(self.servos.items()):
            lines += ["", f"[servos.{json.dumps(name)}]", *_departures(own)]
        return "\n".join(lines).lstrip("\n") + "\n"

    def applied(self, robot: Robot) -> Robot:
        """Applies these factors to a robot's drives and masses; the same robot gets the same answer.

        Raises:
            ConfigError: the robot has no servo of a name in `servos`.
        """
        return robot if self == NOMINAL else _applied(self, robot)

    def adjust(self, servo: ServoModel) -> ServoModel:
        """Applies these factors, or its own, to a servo."""
        own = self.servos.get(servo.name, self)
        return replace(
            servo,
            volt=servo.volt * self.supply,
            stall_nm=servo.stall_nm * own.stall * self.supply,
            stall_a=servo.stall_a * self.supply,
            no_load_rpm=servo.no_load_rpm * own.no_load * self.supply,
            frictionloss=servo.frictionloss * own.friction,
            damping=servo.damping * own.friction,
            armature=servo.armature * own.armature,
            p_gain=servo.p_gain * own.gain,
            mass=servo.mass * self.mass,
        )


@lru_cache(maxsize=16)
def _applied(factors: Factors, robot: Robot) -> Robot:
    models = [drive.servo.name for drive in robot.drives]
    for name in factors.servos:
        if name not in models:
            raise ConfigError(f"factors of servo {name}: {robot.name} has none{suggestion(name, models)}")
    skeleton, adjust = robot.skeleton, cache(factors.adjust)  # a robot has few models of servos
    if factors.mass != 1.0:
        segments = tuple(replace(segment, mass=segment.mass * factors.mass) for segment in skeleton.segments)
        skeleton = replace(skeleton, segments=segments)
    mounts = tuple(
        replace(mount, drive=replace(mount.drive, servo=adjust(mount.drive.servo))) for mount in robot.mounts
    )
    return replace(robot, skeleton=skeleton, mounts=mounts)


def _departures(of: DriveFactors) -> list[str]:
    """Lines of TOML for all figures that are not as in the data sheets, tables left out."""
    figures = ((field, getattr(of, field.name)) for field in msgspec.structs.fields(of) if field.name != "servos")
    return [f"{field.name} = {value!r}" for field, value in figures if value != field.default]


def _positive(name: str, value: float) -> None:
    if not value > 0:
        raise ValueError(f"factor {name} is {value}, must be above 0 (1 leaves it as it is)")


def join_factors(some: Factors, others: Factors) -> Factors:
    """Joins what is wrong in two ways; where both say something of a figure, the second counts."""
    said = {
        name: value for name in Factors.__struct_fields__ if (value := getattr(others, name)) != getattr(NOMINAL, name)
    }
    return msgspec.structs.replace(some, **said)


NOMINAL = Factors()
PESSIMISTIC = Factors(stall=0.8, no_load=0.9, friction=1.5, armature=1.3, mass=1.1)
TwinName = Literal["nominal", "pessimistic", "both"]
TWINS: Mapping[str, tuple[Factors, ...]] = {
    "nominal": (NOMINAL,),
    "pessimistic": (PESSIMISTIC,),
    "both": (NOMINAL, PESSIMISTIC),
}


def read_twins(name: str) -> tuple[Factors, ...]:
    """Finds the factors of twins by their name, or reads those of one from a TOML file; the first twin's are checked.

    Raises:
        ConfigError: no such file, or not factors.
    """
    return TWINS[name] if name in TWINS else (Factors.read(Path(name)),)
