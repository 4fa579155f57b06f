"""Options of a robot of kinesic in LeRobot."""

from dataclasses import dataclass, field

from lerobot.robots import RobotConfig


@RobotConfig.register_subclass("kinesic")
@dataclass
class KinesicRobotConfig(RobotConfig):
    """Options of a robot."""

    robot: str = "upper22"  # name or TOML file of the robot
    ports: dict[str, str] = field(default_factory=dict)  # bus -> device; empty: the twin moves
    velocity: float = 0.5  # highest velocity as a fraction of the robot's limits
