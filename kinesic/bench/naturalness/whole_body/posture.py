"""Standing posture at one time, in arm lengths and degrees."""

from dataclasses import astuple, dataclass, fields

import numpy as np

from kinesic.bench.naturalness.whole_body.measures import elbow_angles
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.body.arrays import Floats


@dataclass(frozen=True)
class StandingPosture:
    """Posture of arms and head, equal for mirror images."""

    out: float  # [arm lengths] wrist to the side of its shoulder
    forward: float  # [arm lengths] wrist in front of its shoulder
    down: float  # [arm lengths] wrist below its shoulder
    elbow_out: float  # [arm lengths] elbow to the side of its shoulder
    elbow_forward: float  # [arm lengths] elbow in front of its shoulder
    elbow_flexion: float  # [deg]
    out_difference: float  # [arm lengths] difference of `out` between both arms, without sign
    forward_difference: float  # [arm lengths] difference of `forward` between both arms, without sign
    down_difference: float  # [arm lengths] difference of `down` between both arms, without sign
    flexion_difference: float  # [deg] difference of elbow flexion between both arms, without sign
    head_pitch: float  # [deg] head pitched down; depends on the skeleton's neutral pose
    head_turn: float  # [deg] head turned to the side, without sign
    head_tilt: float  # [deg] head tilted to the side, without sign
    shoulder_tilt: float  # [deg] line of the shoulders, without sign
    breadth: float  # [arm lengths] wrist from the midline; depends on the breadth of the shoulders


POSTURE_NAMES = tuple(field.name for field in fields(StandingPosture))
SKELETON_FEATURES = frozenset(("head_pitch", "breadth"))  # features that depend on the skeleton itself
COMPARED_FEATURES = tuple(name for name in POSTURE_NAMES if name not in SKELETON_FEATURES)


MAX_REST_SPEED = 0.5  # [arm lengths/s] largest hand speed in the first frames of a clip that starts at rest
FIRST_FRAMES = 3  # number of first frames in which MAX_REST_SPEED must hold


def starts_at_rest(motion: BodyMotion) -> bool:
    """Return whether both hands rest in a clip's first frames."""
    steps = (motion.wrists - motion.chest)[:, FIRST_FRAMES] - (motion.wrists - motion.chest)[:, 0]
    duration = float(motion.times[FIRST_FRAMES] - motion.times[0])
    return float(np.linalg.norm(steps, axis=1).max()) / motion.arm / duration < MAX_REST_SPEED


def measure_posture(motion: BodyMotion, frame: int = 0) -> StandingPosture:
    """Measure the posture of arms and head in a frame of motion.

    The axes are vertical, along the shoulders, and ahead.
    """
    axes = posture_axes(motion, frame)
    joints = (motion.shoulders, motion.elbows, motion.wrists)
    shoulders, elbows, wrists = (points[:, frame] @ axes.T for points in joints)
    hand, elbow = (wrists - shoulders) / motion.arm, (elbows - shoulders) / motion.arm
    outward = np.array([1.0, -1.0])
    middle = shoulders.mean(axis=0)
    flexion = elbow_angles(motion)[:, frame]
    head = axes @ motion.head_rotations[frame]
    line = motion.shoulders[0, frame] - motion.shoulders[1, frame]
    return StandingPosture(
        out=float((outward * hand[:, 1]).mean()),
        forward=float(hand[:, 0].mean()),
        down=-float(hand[:, 2].mean()),
        elbow_out=float((outward * elbow[:, 1]).mean()),
        elbow_forward=float(elbow[:, 0].mean()),
        elbow_flexion=float(flexion.mean()),
        out_difference=abs(float((outward * hand[:, 1]) @ outward)),
        forward_difference=abs(float(hand[:, 0] @ outward)),
        down_difference=abs(float(hand[:, 2] @ outward)),
        flexion_difference=abs(float(flexion @ outward)),
        head_pitch=-float(np.degrees(np.arcsin(np.clip(head[2, 0], -1.0, 1.0)))),
        head_turn=abs(float(np.degrees(np.arctan2(head[1, 0], head[0, 0])))),
        head_tilt=abs(float(np.degrees(np.arcsin(np.clip(head[2, 1], -1.0, 1.0))))),
        shoulder_tilt=abs(float(np.degrees(np.arcsin(line[2] / np.linalg.norm(line))))),
        breadth=float((outward * (wrists - middle)[:, 1]).mean()) / motion.arm,
    )


def posture_axes(motion: BodyMotion, frame: int) -> Floats:
    """Return the shoulders' forward, left and up axes as rows (3, 3)."""
    left = motion.shoulders[0, frame] - motion.shoulders[1, frame]
    left = left * [1.0, 1.0, 0.0]
    left = left / np.linalg.norm(left)
    up = np.array([0.0, 0.0, 1.0])
    return np.stack([np.cross(left, up), left, up])


def posture_vector(posture: StandingPosture) -> Floats:
    """Return a posture's features (k,) that do not depend on the skeleton."""
    values = dict(zip(POSTURE_NAMES, astuple(posture), strict=True))
    return np.array([values[name] for name in COMPARED_FEATURES])
