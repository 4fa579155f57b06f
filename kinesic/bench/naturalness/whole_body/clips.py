"""Captured clips of several skeletons and formats as body motion."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from kinesic.bench.naturalness.measures import PROFILE_RATE
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.capture.reading.bvh import read_bvh, read_bvh_skeleton
from kinesic.capture.reading.smartbody import read_motion, read_skeleton
from kinesic.capture.reading.text import read_file
from kinesic.capture.skeleton_motion import NEUTRAL_POSE, CapturedJoint, CapturedMotion, JointFrames, joint_frames

IDLE_CLIPS = re.compile(r"@Idle[A-Za-z]*\d*$|_ToIdle|_WeightShift|^idle\d*$")  # names of clips without gestures
OTHER_CLIPS = re.compile(r"catch|walk")  # names of BVH clips that show no gestures
GESTURE_SET = "bvh gestures"  # name of the set of all BVH files with gestures
OTHER_SET = "bvh other"  # name of the set of all BVH files without gestures
SET_FOLDERS = ("motions",)  # subfolders of a set that hold its clips
MAX_ARM_LENGTH = 3.0  # [m] arm length above which a skeleton counts as given in centimetres
METRES_PER_CENTIMETRE = 0.01  # [m/cm] conversion of lengths
STRAIGHT_RATIO = 0.95  # wrist distance from the shoulder / arm length, above which an arm counts as straight
LEVEL_HEIGHT = 0.2  # [arm lengths] largest height difference of wrists and shoulders in a T-pose
LOWERED_HEIGHT = 0.7  # [arm lengths] smallest distance of both wrists below the shoulders after a T-pose
TO_Z_UP = sealed([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # rotation from y up, z ahead to z up, x ahead


@dataclass(frozen=True)
class JointNames:
    """Names of the measured joints in one family of skeletons."""

    chest: str
    head: str
    hips: tuple[str, str]  # left and right hip; a skeleton may lack both
    arms: tuple[tuple[str, str, str], tuple[str, str, str]]  # shoulder, elbow, wrist; left first


def _arms(shoulder: str, elbow: str, wrist: str, sides: tuple[str, str]) -> tuple[tuple[str, str, str], ...]:
    return tuple((shoulder.format(side), elbow.format(side), wrist.format(side)) for side in sides)


SKELETON_FAMILIES = tuple(
    JointNames(chest, head, hips, (left, right))
    for chest, head, hips, (left, right) in (
        ("JtSpineC", "JtSkullA", ("JtHipLf", "JtHipRt"), _arms("JtShoulder{}", "JtElbow{}", "JtWrist{}", ("Lf", "Rt"))),
        ("Spine3", "Head", ("LeftUpLeg", "RightUpLeg"), _arms("{}Arm", "{}ForeArm", "{}Hand", ("Left", "Right"))),
        ("Chest4", "Head", ("LeftHip", "RightHip"), _arms("{}Shoulder", "{}Elbow", "{}Wrist", ("Left", "Right"))),
        ("Chest", "Head", ("LThigh", "RThigh"), _arms("{}Shoulder", "{}Forearm", "{}Hand", ("L", "R"))),
    )
)


@dataclass(frozen=True)
class UnreadClip:
    """Clip that cannot be compared, with the reason."""

    name: str
    why: str


def read_clips(folder: Path) -> Iterator[BodyMotion | UnreadClip]:
    """Yield the motion of all gesture clips (.skm, .bvh) below a folder.

    The folder of a clip names its set. A clip `ACTOR@NAME.skm` moves `ACTOR.sk`; other clips move the only skeleton
    (.sk, .bvh) in the `skeletons` folder of their set.

    Raises:
        ConfigError: the folder does not exist.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: no such folder")
    named = {path.stem: path for root in (folder.parent / "skeletons", folder) for path in root.rglob("*.sk")}
    for path in sorted((*folder.rglob("*.skm"), *folder.rglob("*.bvh"))):
        if IDLE_CLIPS.search(path.stem) or path.parent.name == "skeletons":
            continue
        try:
            yield read_body_motion(path, named)
        except ConfigError as error:
            yield UnreadClip(path.stem, str(error))


def read_body_motion(path: Path, skeletons: Mapping[str, Path]) -> BodyMotion:
    """Read one captured clip.

    Args:
        path: clip (.skm or .bvh).
        skeletons: skeleton files by the actor's name.

    Raises:
        ConfigError: the clip or its skeleton cannot be read.
    """
    if path.suffix == ".bvh":
        joints, motion = read_bvh(read_file(path), str(path))
    else:
        joints, motion = _load_skeleton(_find_skeleton(path, skeletons)), read_motion(read_file(path), str(path))
    return drop_calibration_pose(_make_motion(path, joints, motion))


def drop_calibration_pose(motion: BodyMotion) -> BodyMotion:
    """Drop the calibration T-pose, if any, at the beginning of a clip."""
    hands = motion.wrists - motion.shoulders
    heights = hands[..., 2] / motion.arm
    is_straight = np.linalg.norm(hands[:, 0], axis=1).min() > STRAIGHT_RATIO * motion.arm
    lowered = np.flatnonzero((heights < -LOWERED_HEIGHT).all(axis=0))
    if not is_straight or np.abs(heights[:, 0]).max() > LEVEL_HEIGHT or not lowered.size:
        return motion
    return motion.clip(float(motion.times[lowered[0]]), motion.syncs["end"])


def set_name(path: Path) -> str:
    """Return the name of the set to which a clip belongs."""
    if path.suffix == ".bvh":
        return OTHER_SET if OTHER_CLIPS.search(path.stem) else GESTURE_SET
    return (path.parent.parent if path.parent.name in SET_FOLDERS else path.parent).name


def performance_name(path: Path) -> str:
    """Return the name of a clip's performance: its initial pose and kind.

    Repetitions and versions for other hands belong to one performance.
    """
    return re.sub(r"(_intense)?\d*$|(Lf|Rt|Bt|Both)?\d*$", "", path.stem.partition("@")[2] or path.stem)


def _find_skeleton(path: Path, skeletons: Mapping[str, Path]) -> Path:
    actor = path.stem.partition("@")[0]
    if actor in skeletons:
        return skeletons[actor]
    folder = (path.parent.parent if path.parent.name in SET_FOLDERS else path.parent) / "skeletons"
    candidates = [file for file in folder.glob("*") if file.suffix in (".sk", ".bvh")]
    if len(candidates) != 1:
        raise ConfigError(f"{path}: no skeleton {actor}.sk")
    return candidates[0]


@cache
def _load_skeleton(path: Path) -> tuple[CapturedJoint, ...]:
    read = read_bvh_skeleton if path.suffix == ".bvh" else read_skeleton
    return read(read_file(path), str(path))


def _make_motion(path: Path, joints: Sequence[CapturedJoint], motion: CapturedMotion) -> BodyMotion:
    names = _find_family(path, {joint.name for joint in joints})
    frames, neutral = joint_frames(joints, motion), joint_frames(joints, NEUTRAL_POSE)
    times = _resample_times(motion.times)
    (left, right) = names.arms
    length = float(np.mean([_arm_length(neutral, chain) for chain in names.arms]))
    unit = METRES_PER_CENTIMETRE if length > MAX_ARM_LENGTH else 1.0

    def positions(joint: str) -> Floats:
        samples = unit * frames.positions[joint] @ TO_Z_UP.T
        return np.stack([np.interp(times, motion.times, column) for column in samples.T], axis=1)

    def rotations(joint: str) -> Floats:
        since = TO_Z_UP @ frames.rotations[joint] @ neutral.rotations[joint][0].T @ TO_Z_UP.T
        turned: Floats = Slerp(motion.times, Rotation.from_matrix(since))(times).as_matrix()
        return turned

    axes = [_direction(neutral, chain) for chain in names.arms]
    hips = names.hips if frames.positions.keys() >= {*names.hips} else (left[0], right[0])
    syncs = {name: time - float(motion.times[0]) for name, time in motion.syncs.items()}
    return BodyMotion(
        name=path.stem,
        set_name=set_name(path),
        performance=performance_name(path),
        times=sealed(times - motion.times[0]),
        syncs={**syncs, "start": 0.0, "end": float(times[-1] - times[0])},
        arm=unit * length,
        hip_lines=sealed(positions(hips[0]) - positions(hips[1])),
        chest=sealed(positions(names.chest)),
        shoulders=sealed([positions(left[0]), positions(right[0])]),
        elbows=sealed([positions(left[1]), positions(right[1])]),
        wrists=sealed([positions(left[2]), positions(right[2])]),
        chest_rotations=sealed(rotations(names.chest)),
        head_rotations=sealed(rotations(names.head)),
        hand_rotations=sealed([rotations(left[2]), rotations(right[2])]),
        hand_axes=sealed(axes),
    )


def _resample_times(times: Floats) -> Floats:
    count = int(np.floor((times[-1] - times[0]) * PROFILE_RATE + 1e-6)) + 1
    resampled: Floats = np.minimum(times[0] + np.arange(count) / PROFILE_RATE, times[-1])
    return resampled


def _find_family(path: Path, joints: set[str]) -> JointNames:
    for names in SKELETON_FAMILIES:
        if joints.issuperset((names.chest, names.head, *names.arms[0], *names.arms[1])):
            return names
    raise ConfigError(f"{path}: its skeleton has no known names of chest, head and arms")


def _arm_length(neutral: JointFrames, chain: tuple[str, str, str]) -> float:
    shoulder, elbow, wrist = (neutral.positions[name][0] for name in chain)
    return float(np.linalg.norm(elbow - shoulder) + np.linalg.norm(wrist - elbow))


def _direction(neutral: JointFrames, chain: tuple[str, str, str]) -> Floats:
    forearm = TO_Z_UP @ (neutral.positions[chain[2]][0] - neutral.positions[chain[1]][0])
    unit: Floats = forearm / np.linalg.norm(forearm)
    return unit
