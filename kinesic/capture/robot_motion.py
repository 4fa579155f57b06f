"""Sampled robot motions, possibly beyond the robot's limits."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.capture.clip import ArmPath
from kinesic.sim.kinematics import body_frames

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
    """Compute elbow and wrist positions relative to the shoulders [arm lengths].

    Axes are those of the segment that carries the arm.

    Args:
        robot: the robot.
        angles: (m, n) [rad].
    """
    frames, paths = body_frames(robot, angles), {}
    for side in SIDES:
        arm = robot.arm(side)
        base = robot.skeleton.segments[robot.skeleton.segment(arm.segments[0])].parent
        rotation = frames.rotations[robot.skeleton.segment(base)] if base else np.eye(3)[:, :, None]
        shoulder, elbow, wrist = (frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist))
        elbows, wrists = (
            np.einsum("ji...,j...->...i", rotation, place - shoulder) / robot.arm_length for place in (elbow, wrist)
        )
        paths[side] = ArmPath(sealed(elbows), sealed(wrists))
    return paths
