"""Chains of ball joints, modelled as point masses and springs (thesis 7.3.1).

Solvers divide every length by the chain's own, so thresholds mean the same for a finger and for a crane.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from kinesic.body.arrays import Floats, sealed
from kinesic.ik.thesis.boxes import EulerBoxes

MIN_BONE_RATIO = 1e-9  # bone length / chain length below which a bone has no direction


@dataclass(frozen=True, eq=False)
class BallChain:
    """Chain of ball joints in its rest posture."""

    points: Floats  # (n + 1, 3) [m] the base, the joints between the bones, the end effector
    ups: Floats  # (n, 3) unit, perpendicular to each bone; they define its twist
    masses: Floats  # (n + 1,) of the points; only their ratios matter
    stiffness: Floats  # (n,) of the bones; only their ratios matter
    damping: float | None = None  # fraction of its velocity that a mass loses per iteration; None: recommended value
    limits: EulerBoxes | None = None  # of the joints' rotations away from rest

    @classmethod
    def of(
        cls,
        points: ArrayLike,
        *,
        up: ArrayLike = (0.0, 0.0, 1.0),
        masses: ArrayLike = 1.0,
        stiffness: ArrayLike = 1.0,
        damping: float | None = None,
        limits: EulerBoxes | None = None,
    ) -> "BallChain":
        """Make a chain from its joint positions at rest.

        Args:
            points: (n + 1, 3) [m].
            up: (3,) preferred up vector of all bones; its component along a bone is removed.
            masses: one for all, or (n + 1,).
            stiffness: one for all, or (n,).
            damping: in [0, 1); None derives it.
            limits: boxes of n joints.

        Raises:
            ValueError: a bone without length, a number that is not finite, a mass or stiffness not above zero.
        """
        places = sealed(points)
        if places.ndim != 2 or places.shape[1] != 3 or len(places) < 2:
            raise ValueError(f"points have the shape {places.shape}; a chain needs (n + 1, 3) with n >= 1")
        _finite("points", places)
        bones = np.diff(places, axis=0)
        lengths = np.linalg.norm(bones, axis=1)
        for k, length in enumerate(lengths):
            if length <= MIN_BONE_RATIO * lengths.sum():
                raise ValueError(
                    f"bone {k}, from point {k} to {k + 1}, is {length:g} m long; every bone needs a length"
                )
        ups = perpendicular(np.asarray(up, dtype=np.float64), bones / lengths[:, None])
        return cls(
            places,
            sealed(ups),
            sealed(np.broadcast_to(np.asarray(masses, dtype=np.float64), (len(places),))),
            sealed(np.broadcast_to(np.asarray(stiffness, dtype=np.float64), (len(bones),))),
            damping,
            limits,
        )

    @classmethod
    def curved(
        cls, lengths: ArrayLike, *, bend: float = np.radians(10.0), base: ArrayLike = (0.0, 0.0, 0.0)
    ) -> "BallChain":
        """Make a chain with a small bend at each joint at rest.

        A straight rest is the one posture that springs along the bones cannot leave by themselves.

        Args:
            lengths: (n,) [m].
            bend: [rad] from each bone to the next.
            base: (3,) [m].
        """
        sizes = np.asarray(lengths, dtype=np.float64)
        angles = bend * np.arange(len(sizes))
        bones = sizes[:, None] * np.stack([np.cos(angles), np.zeros_like(angles), np.sin(angles)], axis=1)
        return cls.of(np.asarray(base, dtype=np.float64) + np.vstack([np.zeros(3), np.cumsum(bones, axis=0)]))

    def __post_init__(self) -> None:
        bones = len(self.points) - 1
        for name, values in (("masses", self.masses), ("stiffness", self.stiffness)):
            _finite(name, values)
            if (values <= 0.0).any():
                raise ValueError(f"{name} are {values.tolist()}; each must be above zero")
        if self.damping is not None and not 0.0 <= self.damping < 1.0:
            raise ValueError(f"damping is {self.damping}, outside [0, 1): the fraction of velocity lost per iteration")
        if self.limits is not None and len(self.limits.lower) != bones:
            raise ValueError(f"limits are given for {len(self.limits.lower)} joints; the chain has {bones}")

    @cached_property
    def lengths(self) -> Floats:
        """Lengths of the bones, shape (n,) [m]."""
        return sealed(np.linalg.norm(np.diff(self.points, axis=0), axis=1))

    @cached_property
    def size(self) -> float:
        """Sum of the bone lengths (D_max of eq. 7.3.7) [m]."""
        return float(self.lengths.sum())

    @cached_property
    def frames(self) -> Floats:
        """Bone frames at rest, (n, 3, 3): columns forward, sideways, up."""
        along = np.diff(self.points, axis=0) / self.lengths[:, None]
        return sealed(np.stack([along, np.cross(self.ups, along), self.ups], axis=2))

    def beyond(self, joints: int) -> "BallChain":
        """Return the chain without its first `joints` joints."""
        limits = None if self.limits is None else self.limits.beyond(joints)
        return BallChain(
            self.points[joints:],
            self.ups[joints:],
            self.masses[joints:],
            self.stiffness[joints:],
            self.damping,
            limits,
        )


def perpendicular(wish: Floats, along: Floats) -> Floats:
    """Return unit vectors perpendicular to directions, nearest to a preferred vector.

    Args:
        wish: (3,) or (n, 3).
        along: (n, 3) unit.

    Returns:
        (n, 3); if the wish lies along a direction, the coordinate axis that lies least along it is used instead.
    """
    across = wish - (along * wish).sum(axis=1, keepdims=True) * along
    lost = np.linalg.norm(across, axis=1) < 1e-6 * max(float(np.linalg.norm(wish)), 1e-300)
    spare = np.eye(3)[np.argmin(np.abs(along[lost]), axis=1)]
    across[lost] = spare - (along[lost] * spare).sum(axis=1, keepdims=True) * along[lost]
    result: Floats = across / np.linalg.norm(across, axis=1, keepdims=True)
    return result


def _finite(name: str, values: Floats) -> None:
    if not np.isfinite(values).all():
        raise ValueError(f"{name} are {values.tolist()}; every number must be finite")
