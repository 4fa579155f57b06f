"""How far the real servos may be from their data sheets: the same robot, made weaker and heavier."""

from dataclasses import replace
from pathlib import Path

import msgspec

from kinesic.body.config import read
from kinesic.body.robot import Robot
from kinesic.body.servo import Drive


class Factors(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Multipliers on a robot's figures; 1 leaves a figure as it is."""

    stall: float = 1.0
    no_load: float = 1.0
    friction: float = 1.0  # Coulomb and viscous
    armature: float = 1.0
    mass: float = 1.0  # of structure and servos

    def __post_init__(self) -> None:
        """Refuses factors that are not positive.

        Raises:
            ValueError: names the factor and its value.
        """
        for name, value in msgspec.structs.asdict(self).items():
            if not value > 0:
                raise ValueError(f"factor {name} is {value}, must be above 0 (1 leaves it as it is)")

    @classmethod
    def read(cls, path: Path) -> "Factors":
        """Reads factors from a TOML file; those not named are 1.

        Raises:
            ConfigError: the file is missing or wrong.
        """
        return read(path, cls)

    def applied(self, robot: Robot) -> Robot:
        """The same robot with these factors on its drives and masses."""
        if self == NOMINAL:
            return robot
        skeleton = robot.skeleton
        segments = tuple(replace(segment, mass=segment.mass * self.mass) for segment in skeleton.segments)
        mounts = tuple(replace(mount, drive=self._drive(mount.drive)) for mount in robot.mounts)
        return replace(robot, skeleton=replace(skeleton, segments=segments), mounts=mounts)

    def _drive(self, drive: Drive) -> Drive:
        servo = drive.servo
        return replace(
            drive,
            servo=replace(
                servo,
                stall_nm=servo.stall_nm * self.stall,
                no_load_rpm=servo.no_load_rpm * self.no_load,
                frictionloss=servo.frictionloss * self.friction,
                damping=servo.damping * self.friction,
                armature=servo.armature * self.armature,
                mass=servo.mass * self.mass,
            ),
        )


NOMINAL = Factors()
PESSIMISTIC = Factors(stall=0.8, no_load=0.9, friction=1.5, armature=1.3, mass=1.1)
