"""Joints that a ROS controller moves, and their messages."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.ros.rosbridge import Message

JOINT_STATE_TYPE = "sensor_msgs/msg/JointState"  # ROS type of positions at one time
TRAJECTORY_TYPE = "trajectory_msgs/msg/JointTrajectory"  # ROS type of positions at many times
NANOSECONDS_PER_SECOND = 1_000_000_000  # nanoseconds per second
SENT_DECIMALS = 7  # decimal places of sent numbers [rad, rad/s, rad/s^2]


@dataclass(frozen=True, eq=False)
class RosJoints:
    """Joints with the order, names and zeros of the robot's file."""

    robot: Robot
    names: tuple[str, ...]  # (j,) joint names in ROS
    columns: tuple[int, ...]  # (j,) index of each joint among all joints of the file

    @classmethod
    def of(cls, robot: Robot, names: Sequence[str] | None = None) -> "RosJoints":
        """Choose joints of a robot.

        Args:
            robot: built-in or imported robot.
            names: joint names in the robot's own file; None: all joints.

        Raises:
            ConfigError: the robot has no joint of a name, or a name is repeated.
        """
        known = robot.source_joints.names
        chosen = known if names is None else tuple(names)
        unknown = [name for name in chosen if name not in known]
        if unknown:
            raise ConfigError(f"{robot.name} has no joint {unknown[0]!r}; its joints: {', '.join(known)}")
        if not chosen or len(set(chosen)) < len(chosen):
            raise ConfigError(f"joints {list(chosen)}: must be one or more different names")
        return cls(robot, chosen, tuple(known.index(name) for name in chosen))

    def positions(self, angles: Floats) -> Floats:
        """Return joint positions (j,) [rad] of hinge angles (n,)."""
        return sealed(self.robot.source_joints.joint_angles(angles)[list(self.columns)])

    def rates(self, rates: Floats) -> Floats:
        """Return joint velocities or accelerations (j,) of those of hinges (n,)."""
        return sealed(self.robot.source_joints.joint_rates(rates)[list(self.columns)])


def joint_state(names: Sequence[str], positions: Floats, velocities: Floats) -> Message:
    """Return a joint state, to which rosbridge adds the present time."""
    return {"name": list(names), "position": _numbers(positions), "velocity": _numbers(velocities), "effort": []}


def trajectory_point(time: float, positions: Floats, velocities: Floats, accelerations: Floats) -> Message:
    """Return a point of a joint trajectory."""
    return {
        "positions": _numbers(positions),
        "velocities": _numbers(velocities),
        "accelerations": _numbers(accelerations),
        "effort": [],
        "time_from_start": duration(time),
    }


def joint_trajectory(names: Sequence[str], points: Sequence[Message]) -> Message:
    """Return a joint trajectory that begins as soon as it arrives."""
    header = {"stamp": duration(0.0), "frame_id": ""}
    return {"header": header, "joint_names": list(names), "points": list(points)}


def duration(seconds: float) -> Message:
    """Return a time or duration [s] as ROS writes it."""
    whole, rest = divmod(round(seconds * NANOSECONDS_PER_SECOND), NANOSECONDS_PER_SECOND)
    return {"sec": whole, "nanosec": rest}


def _numbers(values: Floats) -> list[float]:
    rounded: list[float] = np.round(values, SENT_DECIMALS).tolist()
    return rounded
