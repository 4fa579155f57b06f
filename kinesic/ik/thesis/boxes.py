"""Euler-angle limits of ball joints (thesis 7.3.3)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import IDENTITY_ROTATION, rotation_about

EulerOrder = Literal["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"]  # extrinsic; "xyz" is the thesis's R = Rz Ry Rx
GIMBAL_COSINE = 1e-9  # cosine of the middle Euler angle below which gimbal lock is assumed


@dataclass(frozen=True, eq=False)
class EulerBoxes:
    """Euler-angle limits of each joint relative to its rest orientation.

    The x axis of a bone's frame runs along it, z is its up vector.
    """

    lower: Floats  # (n, 3) [rad] about x, y, z
    upper: Floats  # (n, 3) [rad] about x, y, z
    order: EulerOrder = "xyz"  # the axis turned first, second, third, all fixed in the bone's rest frame

    @classmethod
    def of(cls, lower: ArrayLike, upper: ArrayLike, *, joints: int, order: EulerOrder = "xyz") -> "EulerBoxes":
        """Make limits from lower and upper angles [rad], per joint or common.

        Raises:
            ValueError: a lower limit above its upper one, or a limit that no decomposition can return.
        """
        shape = (joints, 3)
        low, high = (np.broadcast_to(np.asarray(side, dtype=np.float64), shape) for side in (lower, upper))
        return cls(sealed(low), sealed(high), order)

    def __post_init__(self) -> None:
        most = self.widest
        for joint, axis in np.ndindex(*self.lower.shape):
            low, high, name = self.lower[joint, axis], self.upper[joint, axis], "xyz"[axis]
            if not low <= high:
                raise ValueError(f"limits of joint {joint} about {name} are [{low:g}, {high:g}] rad; swap them")
            if low < -most[axis] - GIMBAL_COSINE or high > most[axis] + GIMBAL_COSINE:
                raise ValueError(
                    f"limits of joint {joint} about {name} are [{low:g}, {high:g}] rad; in the order {self.order} "
                    f"that angle lies in [{-most[axis]:.4g}, {most[axis]:.4g}]"
                )

    @property
    def widest(self) -> Floats:
        """Largest Euler angles (3,) [rad] of a joint without limits.

        They are about x, y and z.
        """
        return sealed([np.pi / 2.0 if axis == self.order[1] else np.pi for axis in "xyz"])

    def clamp(self, rotation: Floats, joint: int) -> Floats:
        """Clip a joint rotation (3, 3) to its Euler-angle limits."""
        angles = angles_of(rotation, self.order)
        cut = _nearest(angles, self.lower[joint], self.upper[joint])
        return rotation if np.array_equal(cut, angles) else rotation_of(cut, self.order)

    def beyond(self, joints: int) -> "EulerBoxes":
        """Return the limits without the first `joints` joints."""
        return EulerBoxes(self.lower[joints:], self.upper[joints:], self.order)

    def excess(self, rotations: Floats) -> float:
        """Return the largest violation [rad] of the limits by joint rotations."""
        angles = np.array([angles_of(rotation, self.order) for rotation in rotations])
        return float(np.maximum(0.0, np.maximum(self.lower - angles, angles - self.upper)).max())


def angles_of(rotation: Floats, order: EulerOrder) -> Floats:
    """Convert a rotation matrix to Euler angles (3,) [rad].

    The angles are about x, y and z, with R = R_k R_j R_i for the order "ijk".
    """
    i, j, k = ("xyz".index(axis) for axis in order)
    hand = 1.0 if (j - i) % 3 == 1 else -1.0
    r = rotation
    angles = np.zeros(3)
    level = float(np.hypot(r[i, i], r[j, i]))
    angles[j] = np.arctan2(-hand * r[k, i], level)
    if level > GIMBAL_COSINE:
        angles[i] = np.arctan2(hand * r[k, j], r[k, k])
        angles[k] = np.arctan2(hand * r[j, i], r[i, i])
    else:
        angles[k] = np.arctan2(-hand * r[i, j], r[j, j])
    return angles


def rotation_of(angles: Floats, order: EulerOrder) -> Floats:
    """Convert Euler angles (3,) [rad] about fixed axes to a rotation matrix."""
    turns = rotation_about(IDENTITY_ROTATION, angles)
    first, second, third = (turns["xyz".index(axis)] for axis in order)
    matrix: Floats = third @ second @ first
    return matrix


def _nearest(angles: Floats, lower: Floats, upper: Floats) -> Floats:
    """Clip angles [rad] to the nearer of their limits, modulo 2 pi."""
    below, above = (np.abs(np.remainder(angles - side + np.pi, 2.0 * np.pi) - np.pi) for side in (lower, upper))
    outside = (angles < lower) | (angles > upper)
    return np.where(outside, np.where(below <= above, lower, upper), angles)
