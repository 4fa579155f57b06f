"""Deviations of real servos and masses from the robot's description."""

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

MAX_PLAY = 0.2  # [rad] largest plausible backlash; a gear with more is broken
MAX_RESISTANCE = 5.0  # [ohm] largest plausible resistance of a supply for servos


class DriveFactors(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Multipliers on the parameters of a servo model.

    1 leaves a parameter unchanged.
    """

    stall: float = 1.0  # stall torque
    no_load: float = 1.0  # no-load velocity
    friction: float = 1.0  # Coulomb and viscous friction
    armature: float = 1.0  # rotor inertia
    gain: float = 1.0  # duty per position error

    def __post_init__(self) -> None:
        """Reject parameter factors that are not positive.

        Raises:
            ValueError: names the factor and its value.
        """
        for name in DriveFactors.__struct_fields__:
            _positive(name, getattr(self, name))


class Factors(DriveFactors, frozen=True, forbid_unknown_fields=True):
    """Multipliers on a robot's parameters, and absolute latency, backlash and supply limits."""

    mass: float = 1.0  # masses of structure and servos
    supply: float = 1.0  # supply voltage; stall torque, stall current and no-load speed scale with it
    resistance: float = 0.0  # [ohm] of the supply and its cables; times the total current, it is the voltage drop
    amps: float = inf  # [A] current limit of the supply; its voltage drops until the servos draw no more
    latency: float = 0.0  # [s] from a command until its setpoints reach the servos
    play: float = 0.0  # [rad] backlash of the gears; the servo measures the angle of the hinge
    servos: dict[str, DriveFactors] = {}  # factors of individual servo models, used instead of those above

    def __post_init__(self) -> None:
        """Reject factors, latency, backlash and supply values out of range.

        Raises:
            ValueError: names the factor and its value.
        """
        super().__post_init__()
        _positive("mass", self.mass)
        _positive("supply", self.supply)
        if not 0.0 <= self.latency < 1.0:
            raise ValueError(f"latency is {self.latency} s, must be in [0, 1)")
        if not 0.0 <= self.play < MAX_PLAY:
            raise ValueError(f"play is {self.play} rad, must be in [0, {MAX_PLAY}): 0.0087 is half a degree")
        if not 0.0 <= self.resistance < MAX_RESISTANCE:
            raise ValueError(f"resistance is {self.resistance} ohm, must be in [0, {MAX_RESISTANCE}): 0.1 is usual")
        _positive("amps", self.amps)

    def __hash__(self) -> int:
        """Return a hash of all values, including the table of servos."""
        return hash(msgspec.json.encode(self))

    @classmethod
    def read(cls, path: Path) -> "Factors":
        """Read servo factors from a TOML file.

        Missing keys keep their defaults.

        Raises:
            ConfigError: the file is missing or invalid.
        """
        return read_toml(path, cls)

    def text(self) -> str:
        """Return the servo factors as TOML, without default values."""
        lines = _list_departures(self)
        for name, factors in sorted(self.servos.items()):
            lines += ["", f"[servos.{json.dumps(name)}]", *_list_departures(factors)]
        return "\n".join(lines).lstrip("\n") + "\n"

    def applied(self, robot: Robot) -> Robot:
        """Return the robot with these factors applied to its drives and masses.

        The same arguments return the same object.

        Raises:
            ConfigError: the robot has no servo of a name in `servos`.
        """
        return robot if self == NOMINAL_FACTORS else _apply(self, robot)

    def adjust(self, servo: ServoModel) -> ServoModel:
        """Return a servo model with its factors applied.

        A servo without an entry in `servos` takes the factors of the robot.
        """
        factors = self.servos.get(servo.name, self)
        return replace(
            servo,
            volt=servo.volt * self.supply,
            stall_nm=servo.stall_nm * factors.stall * self.supply,
            stall_a=servo.stall_a * self.supply,
            no_load_rpm=servo.no_load_rpm * factors.no_load * self.supply,
            frictionloss=servo.frictionloss * factors.friction,
            damping=servo.damping * factors.friction,
            armature=servo.armature * factors.armature,
            p_gain=servo.p_gain * factors.gain,
            mass=servo.mass * self.mass,
        )


@lru_cache(maxsize=16)
def _apply(factors: Factors, robot: Robot) -> Robot:
    models = [drive.servo.name for drive in robot.drives]
    for name in factors.servos:
        if name not in models:
            raise ConfigError(f"factors of servo {name}: {robot.name} has none{suggestion(name, models)}")
    skeleton, adjust = robot.skeleton, cache(factors.adjust)  # a robot has few servo models
    if factors.mass != 1.0:
        segments = tuple(replace(segment, mass=segment.mass * factors.mass) for segment in skeleton.segments)
        skeleton = replace(skeleton, segments=segments)
    mounts = tuple(
        replace(mount, drive=replace(mount.drive, servo=adjust(mount.drive.servo))) for mount in robot.mounts
    )
    return replace(robot, skeleton=skeleton, mounts=mounts)


def _list_departures(of: DriveFactors) -> list[str]:
    """Return TOML lines of all servo factors that are not defaults.

    Tables are left out.
    """
    figures = ((field, getattr(of, field.name)) for field in msgspec.structs.fields(of) if field.name != "servos")
    return [f"{field.name} = {value!r}" for field, value in figures if value != field.default]


def _positive(name: str, value: float) -> None:
    if not value > 0:
        raise ValueError(f"factor {name} is {value}, must be above 0 (1 leaves it as it is)")


def join_factors(first: Factors, second: Factors) -> Factors:
    """Merge two sets of servo factors.

    Non-default values of the second take precedence.
    """
    changes = {
        name: value
        for name in Factors.__struct_fields__
        if (value := getattr(second, name)) != getattr(NOMINAL_FACTORS, name)
    }
    return msgspec.structs.replace(first, **changes)


NOMINAL_FACTORS = Factors()  # factors of 1: servos and masses as described
PESSIMISTIC_FACTORS = Factors(stall=0.8, no_load=0.9, friction=1.5, armature=1.3, mass=1.1)  # weaker, heavier servos
TwinName = Literal["nominal", "pessimistic", "both"]
TWIN_FACTORS: Mapping[str, tuple[Factors, ...]] = {
    "nominal": (NOMINAL_FACTORS,),
    "pessimistic": (PESSIMISTIC_FACTORS,),
    "both": (NOMINAL_FACTORS, PESSIMISTIC_FACTORS),
}


def read_twins(name: str) -> tuple[Factors, ...]:
    """Return the servo factors of built-in twins, or of one TOML file.

    The first twin decides the checks of a performance.

    Raises:
        ConfigError: the file is missing or is not a file of factors.
    """
    return TWIN_FACTORS[name] if name in TWIN_FACTORS else (Factors.read(Path(name)),)
