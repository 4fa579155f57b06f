"""Skinning of a figure by linear blending or dual quaternions.

Source: thesis chapter 13.

Linear blending moves a vertex by the weighted mean of its frames' matrices; skin between two strongly rotated frames
would collapse, which the intermediate frames of the rig prevent. Dual quaternions (L. Kavan and others, 2008) average
rigid motions into a rigid motion: nothing collapses, but skin bulges at bends.
"""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.rotation import rotation_about
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.body import DressedPerson
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.rig import FINGER_NAMES, FRAME_INDICES, SKINNING_FRAMES, SkinningFrame
from kinesic.face.display import DisplayError

Blending = Literal["linear", "dual"]
Quaternion = tuple[float, float, float, float]  # w, x, y, z

TWIST_SUFFIX = "_twisting"  # name suffix of hinges that rotate about the axis of their bone
HAND_SEGMENT = "wrist"  # segment that moves fingers missing in the skeleton
MIN_HALF_ANGLE_SINE = 1e-9  # sine of half an angle below which a rotation is not scaled


class Skin:
    """Figure mesh bound to a skeleton."""

    def __init__(self, figure: DressedPerson, skeleton: Skeleton, *, blending: Blending = "linear") -> None:
        """Bind the figure's skin to the skeleton.

        Args:
            figure: figure with the skin.
            skeleton: skeleton whose segments and hinges have the names used by the rig.
            blending: skinning method.

        Raises:
            DisplayError: a body or a hinge is missing.
        """
        self._figure, self._skeleton, self._blending = figure, skeleton, blending
        segment_names = {segment.name for segment in skeleton.segments}
        self.frames = [self._replace_missing_finger(frame, segment_names) for frame in SKINNING_FRAMES]  # (f,)
        missing = [frame.segment for frame in self.frames if frame.segment not in segment_names]
        missing += [name for name in figure.angles if name not in skeleton.names and _find_finger(name) is None]
        if missing:
            raise DisplayError(f"no skin without {missing[0]}: bodies and hinges must have the names of those of human")
        self._segments = [skeleton.segment(frame.segment) for frame in self.frames]
        self._partial = [
            (k, frame, self._list_turns(frame))
            for k, frame in enumerate(self.frames)
            if (frame.rotation_fraction, frame.twist) != (1, 1)
        ]
        self.centres = np.array([figure.centres[frame.segment] for frame in self.frames])  # (f, 3) [m] in the bind pose
        self.inverse_bind_rotations = self._compute_bind_rotations().transpose(
            0, 2, 1
        )  # (f, 3, 3) from world to frame in the bind pose

    def compute_frame_motions(self, angles: Floats) -> tuple[Floats, Floats]:
        """Return each skinning frame's motion from bind pose to world.

        Args:
            angles: (n,) [rad] in joint order.

        Returns:
            (f, 3, 3) rotations and (f, 3) translations [m].
        """
        rotations, origins = self.pose_frames(angles)
        turns = rotations @ self.inverse_bind_rotations
        return turns, origins - np.einsum("fij,fj->fi", turns, self.centres)

    def move_skin(self, positions: Floats, angles: Floats) -> Floats:
        """Move (v, 3) positions [m] of the bind pose into the world.

        Args:
            positions: (v, 3) [m] in the bind pose.
            angles: (n,) [rad] in joint order.
        """
        turns, translations = self.compute_frame_motions(angles)
        if self._blending == "dual":
            return _blend_dual_quaternions(positions, self._figure.weights, turns, translations)
        affine = np.concatenate([turns, translations[:, :, None]], axis=2).reshape(len(turns), 12)
        moved = (self._figure.weights @ affine).reshape(-1, 3, 4)
        return np.asarray(np.einsum("vij,vj->vi", moved[:, :, :3], positions) + moved[:, :, 3])

    def move_with_head(self, points: Floats, angles: Floats) -> Floats:
        """Move (k, 3) points [m] rigidly with the head."""
        turns, translations = self.compute_frame_motions(angles)
        head = FRAME_INDICES["skullbase"]
        return np.asarray(points @ turns[head].T + translations[head])

    def _replace_missing_finger(self, frame: SkinningFrame, segment_names: set[str]) -> SkinningFrame:
        """Return a skinning frame, or the hand's frame for a missing finger."""
        lacks_finger = frame.segment not in segment_names and _find_finger(frame.segment) is not None
        return SkinningFrame(frame.name, f"{frame.segment[:2]}{HAND_SEGMENT}") if lacks_finger else frame

    def _compute_bind_rotations(self) -> Floats:
        """Return the bind pose's (f, 3, 3) rotations of skinning frames.

        Fingers are not coupled there as in the skeleton.
        """
        skeleton, angles = self._skeleton, self._figure.angles
        rotations, _ = self.pose_frames(np.array([angles.get(name, 0.0) for name in skeleton.names]))
        names = [*skeleton.names, *(coupling.name for coupling in skeleton.couplings)]
        rotations_by_segment = dict(zip(self._segments, rotations, strict=True))
        for k, frame in enumerate(self.frames):
            if _find_finger(frame.segment) is not None:
                parent, _, turns = skeleton.steps[self._segments[k]]
                rotation = rotations_by_segment[parent]
                for turn, _ in turns:
                    rotation = rotation @ rotation_about(skeleton.axes[turn], angles.get(names[turn], 0.0))
                rotations[k] = rotations_by_segment[self._segments[k]] = rotation
        return rotations

    def _list_turns(self, frame: SkinningFrame) -> list[tuple[int, tuple[float, ...], float]]:
        """List a skinning frame's hinges, each with axis and applied rotation fraction."""
        return [
            (k, tuple(hinge.axis.tolist()), frame.twist if hinge.name.endswith(TWIST_SUFFIX) else 1.0)
            for k, hinge in enumerate(self._skeleton.hinges)
            if hinge.segment == frame.segment
        ]

    def pose_frames(self, angles: Floats) -> tuple[Floats, Floats]:
        """Return skinning frames' (f, 3, 3) rotations and (f, 3) origins [m].

        They are those of the frames in the world.

        Args:
            angles: (n,) [rad] in joint order.
        """
        stand = self._skeleton.frames(angles)
        rotations, origins = stand.rotations[self._segments], stand.origins[self._segments]
        for k, frame, turns in self._partial:
            swing, twist = (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
            for joint, axis, fraction in turns:
                if self._skeleton.hinges[joint].name.endswith(TWIST_SUFFIX):
                    twist = _make_quaternion(axis, fraction * float(angles[joint]))
                else:
                    swing = _multiply(swing, _make_quaternion(axis, float(angles[joint])))
            parent = self._skeleton.steps[self._segments[k]][0]
            rotations[k] = stand.rotations[parent] @ _to_matrix(
                _multiply(_scale_turn(swing, frame.rotation_fraction), twist)
            )
        return rotations, origins


def _find_finger(name: str) -> str | None:
    """Return the finger to which a segment or hinge belongs, or None."""
    return next((finger for finger in FINGER_NAMES if name[2:].startswith(finger)), None)


def _make_quaternion(axis: Sequence[float], angle: float) -> Quaternion:
    c, s = math.cos(angle / 2), math.sin(angle / 2)
    return c, s * axis[0], s * axis[1], s * axis[2]


def _multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def _scale_turn(q: Quaternion, fraction: float) -> Quaternion:
    """Return the quaternion of a fraction of a rotation.

    The direction of rotation stays the same, also beyond half a turn.
    """
    sine = math.hypot(*q[1:])
    if fraction == 1.0 or sine < MIN_HALF_ANGLE_SINE:
        return q
    half = fraction * math.atan2(sine, q[0])
    scale = math.sin(half) / sine
    return math.cos(half), scale * q[1], scale * q[2], scale * q[3]


def _to_matrix(q: Quaternion) -> Floats:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _blend_dual_quaternions(
    positions: Floats, weights: "scipy.sparse.csr_array", turns: Floats, translations: Floats
) -> Floats:
    """Return (v, 3) positions [m] moved by blended dual quaternions.

    Each quaternion has the sign that is nearer to the strongest one of its vertex.
    """
    real = scipy.spatial.transform.Rotation.from_matrix(turns).as_quat(scalar_first=True)
    pure = np.concatenate([np.zeros((len(translations), 1)), translations], axis=1)
    both = np.concatenate([real, 0.5 * _multiply_rows(pure, real)], axis=1)
    strongest = np.asarray(weights.argmax(axis=1)).ravel()
    row = np.repeat(np.arange(weights.shape[0]), np.diff(weights.indptr))
    dots = np.einsum("ei,ei->e", real[weights.indices], real[strongest[row]])
    signed = scipy.sparse.csr_array(
        (weights.data * np.where(dots < 0.0, -1.0, 1.0), weights.indices, weights.indptr), shape=weights.shape
    )
    mixed = signed @ both
    mixed /= np.linalg.norm(mixed[:, :4], axis=1, keepdims=True)
    rotated = scipy.spatial.transform.Rotation.from_quat(mixed[:, :4], scalar_first=True).apply(positions.copy())
    return np.asarray(rotated + 2.0 * _multiply_rows(mixed[:, 4:], mixed[:, :4] * (1.0, -1.0, -1.0, -1.0))[:, 1:])


def _multiply_rows(a: Floats, b: Floats) -> Floats:
    """Return the (n, 4) products of quaternions, w first."""
    return np.stack(_multiply(tuple(a.T), tuple(b.T)), axis=1)
