"""Boxed Euler limits of ball joints (thesis 7.3.3): six boundaries per joint."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, sealed

EulerOrder = Literal["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"]  # extrinsic; "xyz" is the thesis's R = Rz Ry Rx
GIMBAL = 1e-9  # cosine of the middle angle below which the outer two turn about one axis


@dataclass(frozen=True, eq=False)
class EulerBoxes:
    """Rotations away from rest that each joint allows, in the frame of its bone: x along it, z its up vector."""

    lower: Floats  # (n, 3) [rad] about x, y, z
    upper: Floats  # (n, 3) [rad] about x, y, z
    order: EulerOrder = "xyz"  # the axis turned first, second, third, all fixed in the bone's rest frame

    @classmethod
    def of(cls, lower: ArrayLike, upper: ArrayLike, *, joints: int, order: EulerOrder = "xyz") -> "EulerBoxes":
        """Makes boxes from (3,) for all joints, or (n, 3) [rad].

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
            if low < -most[axis] - GIMBAL or high > most[axis] + GIMBAL:
                raise ValueError(
                    f"limits of joint {joint} about {name} are [{low:g}, {high:g}] rad; in the order {self.order} "
                    f"that angle lies in [{-most[axis]:.4g}, {most[axis]:.4g}]"
                )

    @property
    def widest(self) -> Floats:
        """(3,) [rad] about x, y, z: limits of +- this leave a joint free."""
        return sealed([np.pi / 2.0 if axis == self.order[1] else np.pi for axis in "xyz"])

    def clamp(self, rotation: Floats, joint: int) -> Floats:
        """Cuts off each angle of a rotation (3, 3) away from rest at its limit; one inside comes back itself."""
        angles = angles_of(rotation, self.order)
        cut = _nearest(angles, self.lower[joint], self.upper[joint])
        return rotation if np.array_equal(cut, angles) else rotation_of(cut, self.order)

    def beyond(self, joints: int) -> "EulerBoxes":
        """Leaves out the boxes of the first joints."""
        return EulerBoxes(self.lower[joints:], self.upper[joints:], self.order)

    def excess(self, rotations: Floats) -> float:
        """Measures how far the worst angle of (n, 3, 3) rotations lies outside its box [rad]; 0 inside."""
        angles = np.array([angles_of(rotation, self.order) for rotation in rotations])
        return float(np.maximum(0.0, np.maximum(self.lower - angles, angles - self.upper)).max())


def angles_of(rotation: Floats, order: EulerOrder) -> Floats:
    """Finds the angles (3,) [rad] about x, y, z of a rotation R = R_k R_j R_i, where order = "ijk".

    In gimbal lock the first angle is zero.
    """
    i, j, k = ("xyz".index(axis) for axis in order)
    hand = 1.0 if (j - i) % 3 == 1 else -1.0
    r = rotation
    angles = np.zeros(3)
    level = float(np.hypot(r[i, i], r[j, i]))
    angles[j] = np.arctan2(-hand * r[k, i], level)
    if level > GIMBAL:
        angles[i] = np.arctan2(hand * r[k, j], r[k, k])
        angles[k] = np.arctan2(hand * r[j, i], r[i, i])
    else:
        angles[k] = np.arctan2(-hand * r[i, j], r[j, j])
    return angles


def rotation_of(angles: Floats, order: EulerOrder) -> Floats:
    """Makes a rotation (3, 3) of (3,) [rad] about x, y, z, turned in an order about fixed axes."""
    turns = [angles["xyz".index(axis)] for axis in order]
    matrix: Floats = Rotation.from_euler(order, turns).as_matrix()
    return matrix


def _nearest(angles: Floats, lower: Floats, upper: Floats) -> Floats:
    """Each angle, or the limit that is nearer on the circle."""
    below, above = (np.abs(np.remainder(angles - side + np.pi, 2.0 * np.pi) - np.pi) for side in (lower, upper))
    outside = (angles < lower) | (angles > upper)
    return np.where(outside, np.where(below <= above, lower, upper), angles)
