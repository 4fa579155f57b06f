"""What planning must know of the body's physics; implemented by `sim`, joined by `controller`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from kinesic.body.arrays import Floats


@dataclass(frozen=True, eq=False)
class Load:
    """Largest holding torque and inertia of each hinge over all postures, the larger of both sides."""

    holding: Floats  # (n,) [Nm] torque against gravity
    inertia: Floats  # (n,) [kg m^2] diagonal of the joint-space inertia, armature included


class Dynamics(Protocol):
    """Inverse dynamics of a robot, in joint order."""

    def torques(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        """Computes the torque that each motion needs, gravity, inertia, armature and friction included.

        Args:
            angles: (m, n) [rad].
            speeds: (m, n) [rad/s].
            accelerations: (m, n) [rad/s^2].

        Returns:
            (m, n) [Nm].
        """

    @property
    def load(self) -> Load:
        """What each hinge bears at worst."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Closest approach of two segments along a motion."""

    distances: Floats  # (m,) [m] smallest distance over all counted pairs, negative when they overlap
    pairs: Sequence[tuple[str, str]]  # (m,) the segments that are closest

    @property
    def worst(self) -> int:
        """Index of the closest approach."""
        return int(self.distances.argmin())


class Distances(Protocol):
    """Self-distance of a robot."""

    def clearance(self, angles: Floats) -> Clearance:
        """Finds the smallest distance between the capsules of counted pairs, for (m, n) [rad]."""

    def gaps(self, angles: Floats) -> Floats:
        """Measures (m, p) [m] between the segments of each counted pair, in their order, for (m, n) [rad]."""

    def bounds(self, angles: Floats, turns: Floats) -> Floats:
        """Bounds the distances (m,) [m] of postures (m, n) [rad] from below, however hinges turn by (m, n) [rad]."""
