"""Arms, hands, head and trunk of captured skeletons, in the chest frame."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES
from kinesic.body.rotation import rotation_to_vector
from kinesic.capture.body_joints import BodyJoints, find_body_joints
from kinesic.capture.clip import ArmPath, BodyClip, HandTrack
from kinesic.capture.hand_joints import find_fingers, measure_hand_pose
from kinesic.capture.reading.text import CaptureError, check_numbers
from kinesic.capture.skeleton_motion import (
    NEUTRAL_POSE,
    CapturedJoint,
    CapturedMotion,
    JointFrames,
    joint_frames,
    select_ancestors,
)

MAX_JOINT_FRAMES = 2_000_000  # largest accepted frames x joints (measured joints and their ancestors)
MIN_LENGTH = 1e-6  # shortest accepted spine, shoulder line and arm, in the unit of the file
LEVEL_HEIGHT = 0.2  # [arm lengths] largest height of wrists above or below the shoulders in a T-pose
STRAIGHT_DISTANCE = 0.95  # [arm lengths] shoulder-wrist distance above which an arm is straight
LOWERED_HEIGHT = -0.7  # [arm lengths] wrist height relative to the shoulder below which an arm is lowered
MIN_UPRIGHT_COSINE = 0.8  # cosine between spine and neck-head line below which a zero pose is not upright


def clip_of_skeleton(skeleton: Sequence[CapturedJoint], motion: CapturedMotion, source: str) -> BodyClip:
    """Convert a skeleton and its motion to arms, hands, head and trunk.

    The chest frame has z from the hips to the neck and y from the right to the left shoulder, so that heading, up axis
    and unit of the file drop out.

    Raises:
        CaptureError: the skeleton is unknown, or has bones of zero length.
    """
    joints = find_body_joints(skeleton, source)
    fingers = {side: find_fingers(skeleton, joints.arms[side][-1]) for side in SIDES}
    finger_names = {name for chains in fingers.values() for chain in chains.values() for name in chain}
    used = select_ancestors(skeleton, _names(joints) | finger_names)
    if len(used) * len(motion.times) > MAX_JOINT_FRAMES:
        raise CaptureError(f"{source}: {len(motion.times)} frames of {len(used)} joints are too many; cut the file")
    frames, neutral = joint_frames(used, motion), joint_frames(used, NEUTRAL_POSE)
    chest = chest_frames(frames.positions, joints, source)
    arms = {side: _arm_path(frames.positions, chest, joints.arms[side], source) for side in SIDES}
    hands = {
        side: measure_hand_pose(frames.positions, chest, joints.arms[side][-1], fingers[side], side) for side in SIDES
    }
    head, head_guess = _head_rotations(frames, neutral, chest, joints)
    check_numbers(np.concatenate([path for arm in arms.values() for path in (arm.elbow, arm.wrist)]), source)
    start = float(motion.times[0])
    clip = BodyClip(
        times=sealed(motion.times - start),
        arms=arms,
        head=sealed(head),
        syncs={name: time - start for name, time in motion.syncs.items()},
        guesses=tuple(guess for guess in (joints.guess, head_guess) if guess),
        hands={side: hand for side, hand in hands.items() if hand is not None},
        trunk=sealed(rotation_to_vector(_mean_frame(chest).T @ chest)),
        half_width=_half_width(frames.positions, joints),
        upper_arm=float(np.median([np.linalg.norm(arm.elbow, axis=1) for arm in arms.values()])),
    )
    return skip_calibration(clip)


def skip_calibration(clip: BodyClip) -> BodyClip:
    """Remove an initial T-pose from a clip, until both wrists are lowered."""
    wrists = np.stack([arm.wrist for arm in clip.arms.values()])
    is_level = np.abs(wrists[:, 0, 2]) < LEVEL_HEIGHT
    is_straight = np.linalg.norm(wrists[:, 0], axis=1) > STRAIGHT_DISTANCE
    lowered = np.flatnonzero((wrists[:, :, 2] < LOWERED_HEIGHT).all(axis=0))
    if not (is_level & is_straight).all() or not lowered.size or lowered[0] > len(clip.times) - 2:
        return clip
    first = int(lowered[0])
    start = float(clip.times[first])
    return replace(
        clip,
        times=sealed(clip.times[first:] - start),
        arms={side: ArmPath(sealed(arm.elbow[first:]), sealed(arm.wrist[first:])) for side, arm in clip.arms.items()},
        head=sealed(clip.head[first:]),
        syncs={name: time - start for name, time in clip.syncs.items()},
        guesses=(*clip.guesses, f"T-pose of the first {start:.2f} s left out"),
        hands={
            side: HandTrack(sealed(hand.pointing[first:]), sealed(hand.palm[first:]), sealed(hand.straight[first:]))
            for side, hand in clip.hands.items()
        },
        trunk=None if clip.trunk is None else sealed(clip.trunk[first:]),
    )


def chest_frames(positions: Mapping[str, Floats], joints: BodyJoints, source: str) -> Floats:
    """Return chest frames (m, 3, 3) with columns forward, left and up.

    Raises:
        CaptureError: spine or shoulder line have zero length.
    """
    left, right = (positions[joints.arms[side][0]] for side in SIDES)
    up = _unit(positions[joints.neck] - positions[joints.hips], f"{source}: spine")
    across = left - right
    across = _unit(across - up * np.sum(across * up, axis=-1, keepdims=True), f"{source}: shoulder line")
    return np.stack([np.cross(across, up), across, up], axis=-1)


def _names(joints: BodyJoints) -> set[str]:
    return {joints.hips, joints.neck, joints.head, *joints.arms["l"], *joints.arms["r"]}


def _arm_path(positions: Mapping[str, Floats], chest: Floats, names: tuple[str, str, str], source: str) -> ArmPath:
    shoulder, elbow, wrist = (positions[name] for name in names)
    bones = np.linalg.norm(elbow - shoulder, axis=1) + np.linalg.norm(wrist - elbow, axis=1)
    length = float(np.median(bones))
    if not length > MIN_LENGTH:
        raise CaptureError(f"{source}: the arm {names[0]} to {names[2]} has no length")
    elbows, wrists = (np.einsum("tji,tj->ti", chest, positions - shoulder) / length for positions in (elbow, wrist))
    return ArmPath(sealed(elbows), sealed(wrists))


def _head_rotations(frames: JointFrames, neutral: JointFrames, chest: Floats, joints: BodyJoints) -> tuple[Floats, str]:
    """Return head rotation vectors (m, 3) [rad] in the chest frame.

    They are measured from the zero pose, or from the mean of the clip if the zero pose is no upright posture.
    The second result reports the use of the mean, otherwise it is empty.
    """
    head = np.einsum("tji,tjk->tik", chest, frames.rotations[joints.head])
    upright = _upright_head(neutral, joints)
    if upright is not None:
        return rotation_to_vector(head @ upright.T), ""
    return rotation_to_vector(head @ _mean_frame(head).T), "head measured from its mean orientation"


def _mean_frame(frames: Floats) -> Floats:
    """Return the mean rotation (3, 3) of rotations (m, 3, 3)."""
    left, _, right = np.linalg.svd(frames.mean(axis=0))
    mean: Floats = left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right
    return mean


def _half_width(positions: Mapping[str, Floats], joints: BodyJoints) -> float:
    """Return half the distance between the shoulders [arm lengths]."""
    bones = [
        np.linalg.norm(positions[b] - positions[a], axis=1)
        for names in joints.arms.values()
        for a, b in pairwise(names)
    ]
    arm_length = float(np.median(np.sum(bones, axis=0))) / len(SIDES)
    left, right = (positions[joints.arms[side][0]] for side in SIDES)
    return float(np.median(np.linalg.norm(left - right, axis=1))) / (2.0 * arm_length)


def _upright_head(neutral: JointFrames, joints: BodyJoints) -> Floats | None:
    """Return the zero pose's head rotation in the chest frame, or None.

    It is None if the zero pose is not upright, or has bones of zero length.
    """
    try:
        (chest,) = chest_frames(neutral.positions, joints, "zero pose")
    except CaptureError:
        return None
    to_head = neutral.positions[joints.head][0] - neutral.positions[joints.neck][0]
    length = float(np.linalg.norm(to_head))
    if length > MIN_LENGTH and float(chest[:, 2] @ to_head) < MIN_UPRIGHT_COSINE * length:
        return None
    upright: Floats = chest.T @ neutral.rotations[joints.head][0]
    return upright


def _unit(vectors: Floats, place: str) -> Floats:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if not (lengths > MIN_LENGTH).all():
        raise CaptureError(f"{place} has no length in frame {int(np.argmin(lengths)) + 1}")
    units: Floats = vectors / lengths
    return units
