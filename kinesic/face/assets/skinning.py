"""Moves the skin of a figure as a skeleton stands: linear blending, or dual quaternions (thesis chapter 13).

Linear blending moves a vertex by the weighted mean of its frames' matrices; skin between two frames that are turned far
against one another collapses, which the rig's frames between them keep from happening. Dual quaternions (L. Kavan and
others, 2008) average rigid motions into a rigid motion: nothing collapses, but skin bulges where it bends.
"""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.rotation import about
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.body import DressedPerson
from kinesic.face.assets.rig import FINGERS, FRAMES, PLACE, SkinningFrame
from kinesic.face.display import DisplayError

Blending = Literal["linear", "dual"]
Quaternion = tuple[float, float, float, float]  # w, x, y, z

TWIST = "_twisting"  # how the name of a hinge about its bone ends
HAND = "wrist"  # whose frame moves fingers that the skeleton lacks
NO_TURN = 1e-9  # sine of half an angle


class Skin:
    """The skin of a figure on a skeleton."""

    def __init__(self, figure: DressedPerson, skeleton: Skeleton, *, blending: Blending = "linear") -> None:
        """Puts the skeleton into the skin.

        Args:
            figure: whose skin it is.
            skeleton: whose segments and hinges have the names that the rig knows.
            blending: how frames are blended.

        Raises:
            DisplayError: a body or a hinge is missing.
        """
        self._figure, self._skeleton, self._blending = figure, skeleton, blending
        known = {segment.name for segment in skeleton.segments}
        self.frames = [self._present(frame, known) for frame in FRAMES]  # (f,)
        missing = [frame.segment for frame in self.frames if frame.segment not in known]
        missing += [name for name in figure.angles if name not in skeleton.names and _finger_of(name) is None]
        if missing:
            raise DisplayError(f"no skin without {missing[0]}: bodies and hinges must have the names of those of human")
        self._segments = [skeleton.segment(frame.segment) for frame in self.frames]
        self._partial = [
            (k, frame, self._turns(frame))
            for k, frame in enumerate(self.frames)
            if (frame.share, frame.twist) != (1, 1)
        ]
        self.centres = np.array([figure.centres[frame.segment] for frame in self.frames])  # (f, 3) [m] at bind
        self.unbound = self._bound().transpose(0, 2, 1)  # (f, 3, 3) from the world to the frame, at bind

    def matrices(self, angles: Floats) -> tuple[Floats, Floats]:
        """Computes how each frame moves skin from the bind pose into the world, (f, 3, 3) and (f, 3) [m].

        Args:
            angles: (n,) [rad] in joint order.
        """
        rotations, origins = self.stand(angles)
        turns = rotations @ self.unbound
        return turns, origins - np.einsum("fij,fj->fi", turns, self.centres)

    def place(self, positions: Floats, angles: Floats) -> Floats:
        """Moves (v, 3) [m] positions of the bind pose to where they are in the world, for angles (n,) [rad]."""
        turns, ways = self.matrices(angles)
        if self._blending == "dual":
            return _dual(positions, self._figure.weights, turns, ways)
        affine = np.concatenate([turns, ways[:, :, None]], axis=2).reshape(len(turns), 12)
        moved = (self._figure.weights @ affine).reshape(-1, 3, 4)
        return np.asarray(np.einsum("vij,vj->vi", moved[:, :, :3], positions) + moved[:, :, 3])

    def carry(self, points: Floats, angles: Floats) -> Floats:
        """Moves (k, 3) [m] points of the head at bind with it, as if it were stiff."""
        turns, ways = self.matrices(angles)
        head = PLACE["skullbase"]
        return np.asarray(points @ turns[head].T + ways[head])

    def _present(self, frame: SkinningFrame, known: set[str]) -> SkinningFrame:
        """The frame, or that of the hand where the skeleton has no such finger."""
        lacks_finger = frame.segment not in known and _finger_of(frame.segment) is not None
        return SkinningFrame(frame.name, f"{frame.segment[:2]}{HAND}") if lacks_finger else frame

    def _bound(self) -> Floats:
        """(f, 3, 3) rotations of the frames at bind, where fingers are not coupled as the skeleton's are."""
        skeleton, angles = self._skeleton, self._figure.angles
        found, _ = self.stand(np.array([angles.get(name, 0.0) for name in skeleton.names]))
        names = [*skeleton.names, *(coupling.name for coupling in skeleton.couplings)]
        turned = dict(zip(self._segments, found, strict=True))
        for k, frame in enumerate(self.frames):
            if _finger_of(frame.segment) is not None:
                parent, _, turns = skeleton.steps[self._segments[k]]
                rotation = turned[parent]
                for turn, _ in turns:
                    rotation = rotation @ about(skeleton.axes[turn], angles.get(names[turn], 0.0))
                found[k] = turned[self._segments[k]] = rotation
        return found

    def _turns(self, frame: SkinningFrame) -> list[tuple[int, tuple[float, ...], float]]:
        """Hinge, axis and share of its angle, for a frame that takes shares."""
        return [
            (k, tuple(hinge.axis.tolist()), frame.twist if hinge.name.endswith(TWIST) else 1.0)
            for k, hinge in enumerate(self._skeleton.hinges)
            if hinge.segment == frame.segment
        ]

    def stand(self, angles: Floats) -> tuple[Floats, Floats]:
        """Computes (f, 3, 3) rotations and (f, 3) [m] origins of the rig's frames in the world, for (n,) [rad]."""
        stand = self._skeleton.frames(angles)
        rotations, origins = stand.rotations[self._segments], stand.origins[self._segments]
        for k, frame, turns in self._partial:
            swing, twist = (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
            for joint, axis, share in turns:
                if self._skeleton.hinges[joint].name.endswith(TWIST):
                    twist = _about(axis, share * float(angles[joint]))
                else:
                    swing = _product(swing, _about(axis, float(angles[joint])))
            parent = self._skeleton.steps[self._segments[k]][0]
            rotations[k] = stand.rotations[parent] @ _matrix(_product(_power(swing, frame.share), twist))
        return rotations, origins


def _finger_of(name: str) -> str | None:
    """Which finger a segment or a hinge belongs to; None where to none."""
    return next((finger for finger in FINGERS if name[2:].startswith(finger)), None)


def _about(axis: Sequence[float], angle: float) -> Quaternion:
    c, s = math.cos(angle / 2), math.sin(angle / 2)
    return c, s * axis[0], s * axis[1], s * axis[2]


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def _power(q: Quaternion, share: float) -> Quaternion:
    """A share of a turn, the way that the hinges went: the sign is kept, also beyond half a turn."""
    sine = math.hypot(*q[1:])
    if share == 1.0 or sine < NO_TURN:
        return q
    half = share * math.atan2(sine, q[0])
    scale = math.sin(half) / sine
    return math.cos(half), scale * q[1], scale * q[2], scale * q[3]


def _matrix(q: Quaternion) -> Floats:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _dual(positions: Floats, weights: "scipy.sparse.csr_array", turns: Floats, ways: Floats) -> Floats:
    """Blends rigid motions as dual quaternions, each with the sign that is nearer to the strongest of its vertex."""
    real = scipy.spatial.transform.Rotation.from_matrix(turns).as_quat(scalar_first=True)
    pure = np.concatenate([np.zeros((len(ways), 1)), ways], axis=1)
    both = np.concatenate([real, 0.5 * _products(pure, real)], axis=1)
    strongest = np.asarray(weights.argmax(axis=1)).ravel()
    row = np.repeat(np.arange(weights.shape[0]), np.diff(weights.indptr))
    dots = np.einsum("ei,ei->e", real[weights.indices], real[strongest[row]])
    signed = scipy.sparse.csr_array(
        (weights.data * np.where(dots < 0.0, -1.0, 1.0), weights.indices, weights.indptr), shape=weights.shape
    )
    mixed = signed @ both
    mixed /= np.linalg.norm(mixed[:, :4], axis=1, keepdims=True)
    turned = scipy.spatial.transform.Rotation.from_quat(mixed[:, :4], scalar_first=True).apply(positions.copy())
    return np.asarray(turned + 2.0 * _products(mixed[:, 4:], mixed[:, :4] * (1.0, -1.0, -1.0, -1.0))[:, 1:])


def _products(a: Floats, b: Floats) -> Floats:
    """(n, 4) products of quaternions, w first."""
    return np.stack(_product(tuple(a.T), tuple(b.T)), axis=1)
