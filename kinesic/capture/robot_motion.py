"""Sampled robot motions, possibly beyond the robot's limits."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic._kernel import sim as kernel
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.capture.clip import ArmPath

SAMPLE_RATE = 100.0  # [Hz] sample rate of desired motions


@dataclass(frozen=True, eq=False)
class RobotMotion:
    """Desired joint angles at `SAMPLE_RATE`, with the arm paths they imitate."""

    times: Floats  # (m,) [s] times of the samples, from 0
    requested: Floats  # (m, n) [rad] joint angles of the source, possibly beyond the joint ranges
    angles: Floats  # (m, n) [rad] joint angles within the joint ranges
    arms: Mapping[Side, ArmPath]  # elbow and wrist paths of the source, at the same times
    syncs: Mapping[str, float]  # BML sync point -> time [s]
    notes: tuple[str, ...] = ()  # sentences about guesses on the source, bridged leaps and unknown joints

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return float(self.times[-1])


def arm_paths(robot: Robot, angles: Floats) -> Mapping[Side, ArmPath]:
    """Compute elbow and wrist positions of both arms relative to the shoulders.

    See `arm_path`.

    Args:
        robot: the robot.
        angles: (m, n) [rad].
    """
    return {side: arm_path(robot, side, angles) for side in SIDES}


def arm_path(robot: Robot, side: Side, angles: Floats) -> ArmPath:
    """Compute elbow and wrist positions relative to the shoulder [arm lengths].

    Axes are those of the segment that carries the arm.

    Args:
        robot: the robot.
        side: of the arm.
        angles: (m, n) [rad].
    """
    frames, turning = _compile_arm(robot, side)
    is_coupled = max(turning) >= angles.shape[1]
    turns = np.ascontiguousarray((robot.skeleton.with_couplings(angles) if is_coupled else angles).T[turning])
    count, segments = len(angles), len(robot.arm(side).segments)
    rotations, origins = np.empty((segments, 3, 3, count)), np.empty((segments, 3, count))
    frames.solve(np.ones(segments, dtype=np.bool_), np.sin(turns), np.cos(turns), rotations, origins)
    shoulder, elbow, wrist = origins[-3:]
    return ArmPath(*(sealed((place - shoulder).T / robot.arm_length) for place in (elbow, wrist)))


@lru_cache(maxsize=16)
def _compile_arm(robot: Robot, side: Side) -> tuple[kernel.MotionFrames, list[int]]:
    """Pack the segments of one arm for the kernel.

    The second value contains the indices of their angles.
    """
    skeleton, frames, turning = robot.skeleton, kernel.MotionFrames(), list[int]()
    for parent, name in enumerate(robot.arm(side).segments, start=-1):
        _, origin, hinges = skeleton.steps[skeleton.segment(name)]
        joints = [joint for joint, _ in hinges]
        places = range(len(turning), len(turning) + len(joints))
        offsets = np.array([np.zeros(3) if at is None else at for _, at in hinges])
        frames.add_link(parent, np.ascontiguousarray(origin), list(places), skeleton.axes[joints], offsets)
        turning += joints
    return frames, turning
