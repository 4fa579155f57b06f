"""Motion of trunk, head and arms, independent of the skeleton."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from kinesic.bench.naturalness.measures import PROFILE_RATE
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot

LEFT_AXIS = sealed([0.0, 1.0, 0.0])  # hip line of robots, whose pelvis never turns
SMOOTHING_WEIGHTS = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0  # weights of neighbouring frames, against capture noise


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """Motion of one body at `PROFILE_RATE`: x forward, y left, z up.

    Arrays of two arms have the left one first. Rotations are those since a neutral pose, which looks ahead.
    """

    name: str
    set_name: str  # name of the captured set, or of the robot that performs
    performance: str  # name of the performance to which the clip belongs
    times: Floats  # (m,) [s]
    syncs: Mapping[str, float]  # [s] times of sync points; `start` and `end` are always there
    arm: float  # [m] arm length from shoulder to wrist
    hip_lines: Floats  # (m, 3) vectors from the right to the left hip; between the shoulders if hips are missing
    chest: Floats  # (m, 3) [m] positions of the chest
    shoulders: Floats  # (2, m, 3) [m]
    elbows: Floats  # (2, m, 3) [m]
    wrists: Floats  # (2, m, 3) [m]
    chest_rotations: Floats  # (m, 3, 3)
    head_rotations: Floats  # (m, 3, 3)
    hand_rotations: Floats  # (2, m, 3, 3)
    hand_axes: Floats  # (2, 3) direction of the straight forearm in the neutral pose

    def clip(self, begin: float, end: float, name: str = "") -> "BodyMotion":
        """Return the part of the motion between two times [s]."""
        kept = (self.times >= begin - 1e-9) & (self.times <= end + 1e-9)
        return replace(
            self,
            name=name or self.name,
            times=sealed(self.times[kept]),
            hip_lines=sealed(self.hip_lines[kept]),
            syncs={**self.syncs, "start": max(begin, self.syncs["start"]), "end": min(end, self.syncs["end"])},
            chest=sealed(self.chest[kept]),
            shoulders=sealed(self.shoulders[:, kept]),
            elbows=sealed(self.elbows[:, kept]),
            wrists=sealed(self.wrists[:, kept]),
            chest_rotations=sealed(self.chest_rotations[kept]),
            head_rotations=sealed(self.head_rotations[kept]),
            hand_rotations=sealed(self.hand_rotations[:, kept]),
        )


def smooth_frames(values: Floats) -> Floats:
    """Smooth values (m, ...) over neighbouring frames."""
    margin = len(SMOOTHING_WEIGHTS) // 2
    padded = np.concatenate([values[:1].repeat(margin, axis=0), values, values[-1:].repeat(margin, axis=0)])
    count = len(values)
    smoothed: Floats = sum(
        (weight * padded[k : k + count] for k, weight in enumerate(SMOOTHING_WEIGHTS)), np.zeros_like(values)
    )
    return smoothed


def make_motion(robot: Robot, angles: Floats, syncs: Mapping[str, float], name: str, performance: str) -> BodyMotion:
    """Convert a robot's joint angles to skeleton-independent body motion.

    Args:
        robot: robot that performs.
        angles: joint angles (m, n) [rad] at `PROFILE_RATE` from time zero.
        syncs: times of sync points [s], with `start` and `end`.
        name: name of the gesture.
        performance: name of the performance; gestures of one share their rest posture.
    """
    skeleton = robot.skeleton
    frames, zero = skeleton.frames(angles), skeleton.zero_frames
    arms = [robot.arm(side) for side in SIDES]
    chest, head = (skeleton.segment(robot.chains[chain][-1]) for chain in ("torso", "neck"))

    def rotations(segment: int) -> Floats:
        return np.asarray(frames.rotations[:, segment] @ zero.rotations[segment].T)

    return BodyMotion(
        name=name,
        set_name=robot.name,
        performance=performance,
        times=sealed(np.arange(len(angles)) / PROFILE_RATE),
        syncs=dict(syncs),
        arm=robot.arm_length,
        hip_lines=sealed(np.broadcast_to(LEFT_AXIS, (len(angles), 3))),
        chest=sealed(frames.origins[:, chest]),
        shoulders=sealed([frames.origins[:, arm.shoulder] for arm in arms]),
        elbows=sealed([frames.origins[:, arm.elbow] for arm in arms]),
        wrists=sealed([frames.origins[:, arm.wrist] for arm in arms]),
        chest_rotations=sealed(rotations(chest)),
        head_rotations=sealed(rotations(head)),
        hand_rotations=sealed([rotations(arm.wrist) for arm in arms]),
        hand_axes=sealed([_unit(zero.origins[arm.wrist] - zero.origins[arm.elbow]) for arm in arms]),
    )


def _unit(vector: Floats) -> Floats:
    scaled: Floats = vector / np.linalg.norm(vector)
    return scaled
