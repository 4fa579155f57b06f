"""Skeletons with captured motion, and their forward kinematics."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, seal_in_place, sealed

AXIS_CHANNELS = ("XPos", "YPos", "ZPos")  # channels of a translation
ROTATION_CHANNEL = "Quat"  # channel of a rotation vector


@dataclass(frozen=True, eq=False)
class CapturedJoint:
    """One joint of a captured skeleton before any motion."""

    name: str
    parent: str | None
    offset: Floats  # (3,) position relative to the parent, in the parent's axes and the unit of the file
    turn: Floats  # (3,) [rad] rotation vector applied before that of the motion


@dataclass(frozen=True, eq=False)
class CapturedMotion:
    """Captured motion of one actor."""

    times: Floats  # (m,) [s] times of the frames
    columns: Mapping[tuple[str, str], slice]  # columns of the frames, by joint and kind of channel
    frames: Floats  # (m, k) translations in the unit of the file, and rotation vectors [rad]
    syncs: Mapping[str, float]  # BML sync point -> time [s]


NEUTRAL_POSE = CapturedMotion(sealed([0.0]), {}, sealed([[0.0]]), {})  # one frame with all joints in the zero pose


@dataclass(frozen=True, eq=False)
class JointFrames:
    """Positions and rotations of all joints in every captured frame.

    World axes are those of the file.
    """

    positions: Mapping[str, Floats]  # (m, 3) positions in the unit of the file
    rotations: Mapping[str, Floats]  # (m, 3, 3) rotations from joint axes to the world


def joint_positions(skeleton: Sequence[CapturedJoint], motion: CapturedMotion) -> Mapping[str, Floats]:
    """Return each joint's positions (m, 3) in the file's unit and axes."""
    return joint_frames(skeleton, motion).positions


def joint_frames(skeleton: Sequence[CapturedJoint], motion: CapturedMotion) -> JointFrames:
    """Compute joint positions and rotations in every captured frame.

    A joint rotates by its own rotation and then by the motion's; its child lies at an offset in the rotated axes.
    """
    count = len(motion.frames)
    local = _local_rotations(skeleton, motion)
    positions: dict[str, Floats] = {}
    rotations: dict[str | None, Floats] = {None: np.broadcast_to(np.eye(3), (count, 3, 3))}
    for joint, rotation in zip(skeleton, local, strict=True):
        offset = np.broadcast_to(joint.offset, (count, 3))
        moved = [(axis, motion.columns.get((joint.name, kind))) for axis, kind in enumerate(AXIS_CHANNELS)]
        for axis, column in moved:
            if column is not None:
                offset = offset + np.eye(3)[axis] * motion.frames[:, column]
        above = rotations[joint.parent]
        base = positions[joint.parent] if joint.parent else np.zeros(3)
        positions[joint.name] = seal_in_place(base + np.einsum("tij,tj->ti", above, offset))
        rotations[joint.name] = seal_in_place(above @ rotation)
    return JointFrames(positions, {name: rotation for name, rotation in rotations.items() if name})


def _local_rotations(skeleton: Sequence[CapturedJoint], motion: CapturedMotion) -> Floats:
    """Return each joint's rotation in its parent's axes (j, m, 3, 3).

    All joints are converted together, which is much faster than one by one.
    """
    rotations = np.tile(
        _make_matrices(np.array([joint.turn for joint in skeleton]))[:, None], (1, len(motion.frames), 1, 1)
    )
    columns = [motion.columns.get((joint.name, ROTATION_CHANNEL)) for joint in skeleton]
    moving = [k for k, column in enumerate(columns) if column is not None]
    if moving:
        vectors = np.stack([motion.frames[:, column] for column in columns if column is not None])
        rotations[moving] = rotations[moving] @ _make_matrices(vectors)
    return rotations


def select_ancestors(skeleton: Sequence[CapturedJoint], names: Collection[str]) -> tuple[CapturedJoint, ...]:
    """Return the named joints and all their ancestors, parents first."""
    chosen = set(names)
    for joint in reversed(skeleton):
        if joint.name in chosen and joint.parent is not None:
            chosen.add(joint.parent)
    return tuple(joint for joint in skeleton if joint.name in chosen)


def _make_matrices(vectors: Floats) -> Floats:
    """Convert rotation vectors (..., 3) to matrices (..., 3, 3)."""
    matrices: Floats = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix()
    return matrices.reshape(*vectors.shape, 3)
