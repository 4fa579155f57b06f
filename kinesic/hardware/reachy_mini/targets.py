"""Targets of a Reachy Mini that show the motion of a humanoid.

The head turns like that of the humanoid, the body follows the trunk, and each antenna shows the height of a hand.
"""

from dataclasses import dataclass
from math import asin, atan2, cos, hypot, radians, sin

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Frames

MAX_TILT = radians(35.0)  # [rad] largest inclination of the head; the daemon allows 40 deg of pitch and of roll
MAX_HEAD_YAW = radians(175.0)  # [rad] largest yaw of the head; the daemon allows 180 deg
MAX_BODY_YAW = radians(155.0)  # [rad] largest yaw of the body; the daemon allows 160 deg
MAX_YAW_DIFFERENCE = radians(60.0)  # [rad] largest yaw of the head relative to the body; the daemon allows 65 deg
RESTING_ANTENNA = 0.17  # [rad] outward angle of an antenna if the hand hangs
ANTENNA_GAIN = 0.8  # [rad] outward angle per height of the hand in arm lengths


@dataclass(frozen=True)
class ReachyTarget:
    """Pose of head, body and antennas [rad]."""

    roll: float  # positive: leans right
    pitch: float  # positive: looks down
    yaw: float  # of the head in the world; positive: looks left
    body_yaw: float  # of the body in the world
    antennas: tuple[float, float]  # right and left; outward angles are negative for the right one

    def as_message(self) -> dict[str, object]:
        """Return the JSON object of the daemon's FullBodyTarget."""
        pose = {"x": 0.0, "y": 0.0, "z": 0.0, "roll": self.roll, "pitch": self.pitch, "yaw": self.yaw}
        return {"target_head_pose": pose, "target_antennas": list(self.antennas), "target_body_yaw": self.body_yaw}


class Puppet:
    """Conversion of a humanoid's angles to targets within limits."""

    def __init__(self, robot: Robot) -> None:
        """Prepare for a humanoid, with or without neck, trunk and arms."""
        self._robot = robot
        self._head, self._trunk = (self._find_end(robot, chain) for chain in ("neck", "torso"))
        self._rest = {side: self._raise(robot.skeleton.rest_frames, side) for side in robot.sides}

    def target(self, angles: Floats) -> ReachyTarget:
        """Return the target for joint angles (n,) [rad]."""
        frames = self._robot.body_frames(angles)
        body_yaw = 0.0 if self._trunk is None else _split(frames.rotations[self._trunk])[2]
        head = self._head if self._head is not None else self._trunk
        roll, pitch, yaw = (0.0, 0.0, 0.0) if head is None else _split(frames.rotations[head])
        tilt = hypot(roll, pitch)
        ratio = min(1.0, MAX_TILT / tilt) if tilt > 0.0 else 1.0
        yaw = float(np.clip(yaw, -MAX_HEAD_YAW, MAX_HEAD_YAW))
        body_yaw = float(np.clip(body_yaw, yaw - MAX_YAW_DIFFERENCE, yaw + MAX_YAW_DIFFERENCE))
        body_yaw = float(np.clip(body_yaw, -MAX_BODY_YAW, MAX_BODY_YAW))
        right, left = (self._antenna(frames, side) for side in reversed(SIDES))
        return ReachyTarget(ratio * roll, ratio * pitch, yaw, body_yaw, (-right, left))

    def _antenna(self, frames: Frames, side: Side) -> float:
        """Return the outward angle [rad] of an antenna."""
        if side not in self._rest:
            return RESTING_ANTENNA
        return RESTING_ANTENNA + ANTENNA_GAIN * max(0.0, self._raise(frames, side) - self._rest[side])

    def _raise(self, frames: Frames, side: Side) -> float:
        """Return the height of a hand above its shoulder, in arm lengths."""
        chain = self._robot.chains[f"{side}_arm"]
        shoulder, wrist = (self._robot.skeleton.segment(chain[k]) for k in (-3, -1))
        return float(frames.origins[wrist][2] - frames.origins[shoulder][2]) / self._robot.arm_length

    @staticmethod
    def _find_end(robot: Robot, chain: str) -> int | None:
        segments = robot.chains.get(chain, ())
        return robot.skeleton.segment(segments[-1]) if segments else None


def _split(rotation: Floats) -> tuple[float, float, float]:
    """Return roll, pitch and yaw [rad] of a rotation matrix (3, 3).

    The rotation is first roll, then pitch, then yaw, about fixed axes.
    """
    pitch = asin(float(np.clip(-rotation[2, 0], -1.0, 1.0)))
    yaw = atan2(rotation[1, 0], rotation[0, 0])
    across = np.array([-sin(yaw), cos(yaw), 0.0])
    roll = atan2(float(-rotation[:, 2] @ across), float(rotation[:, 1] @ across))
    return roll, pitch, yaw
