"""Interfaces of inverse dynamics, segment distances and contacts with people.

`sim` implements them, and `controller` passes them to planning.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from kinesic.body.arrays import Floats, Indices
from kinesic.body.impact_policy import ImpactRows


@dataclass(frozen=True, eq=False)
class Load:
    """Largest holding torque and inertia of each hinge over all postures.

    Mirrored hinges share the larger value of both sides.
    """

    holding: Floats  # (n,) [Nm] torque against gravity
    inertia: Floats  # (n,) [kg m^2] diagonal of the joint-space inertia, armature included


class Dynamics(Protocol):
    """Interface of a robot's inverse dynamics, in joint order."""

    def torques(self, angles: Floats, velocities: Floats, accelerations: Floats) -> Floats:
        """Compute the torques of a motion by inverse dynamics.

        Gravity, inertia, armature and friction are included.

        Args:
            angles: (m, n) [rad].
            velocities: (m, n) [rad/s].
            accelerations: (m, n) [rad/s^2].

        Returns:
            (m, n) [Nm].
        """

    @property
    def load(self) -> Load:
        """Largest holding torque and inertia of each hinge."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Smallest distance between checked bodies in each posture of a motion."""

    distances: Floats  # (m,) [m] minimum over all checked pairs, negative if they overlap
    pairs: Sequence[tuple[str, str]]  # (m,) names of the two closest bodies

    @property
    def worst(self) -> int:
        """Index of the posture with the smallest clearance."""
        return int(self.distances.argmin())


class Distances(Protocol):
    """Interface of distance measurement between a robot's segments."""

    def clearance(self, angles: Floats) -> Clearance:
        """Find the smallest distance of all checked pairs in each posture.

        The angles are (m, n) [rad].
        """

    def gaps(self, angles: Floats, *, exact_below: float = ...) -> Floats:
        """Compute the distance (m, p) [m] of each checked pair.

        Pairs keep the order of `Robot.counted_pairs`; angles are (m, n) [rad]. Distances of fingers above `exact_below`
        [m] may be lower bounds.
        """

    def bounds(self, angles: Floats, turns: Floats) -> Floats:
        """Compute lower bounds (m,) [m] of the clearance near given postures.

        Args:
            angles: (m, n) [rad].
            turns: (m, n) [rad] largest deviation of each hinge from its angle.
        """


@dataclass(frozen=True, eq=False)
class ImpactSurvey:
    """Worst contact of each posture with each region of a person's body."""

    rows: ImpactRows  # computed contact quantities
    values: Floats  # (m, r) contact quantities
    points: Indices  # (m, r) index of the robot's worst point; -1 if the value is only an upper bound


class Impacts(Protocol):
    """Interface of contacts between a moving robot and a person."""

    @property
    def owners(self) -> tuple[str, ...]:
        """Segment of each surface point of the robot."""

    def survey(self, angles: Floats, velocities: Floats, rows: ImpactRows, *, gate: float = 0.0) -> ImpactSurvey:
        """Compute each contact quantity at the robot's worst point per posture.

        Args:
            angles: (m, n) [rad].
            velocities: (m, n) [rad/s].
            rows: quantities to compute.
            gate: value below which an upper bound suffices.
        """

    def jacobians(self, angles: Floats, points: Indices) -> Floats:
        """Compute the Jacobian (m, 3, n) of one surface point per posture.

        Args:
            angles: (m, n) [rad].
            points: (m,) indices of points.
        """
