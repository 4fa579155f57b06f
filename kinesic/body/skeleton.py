"""Skeleton of a robot: a tree of segments joined by hinges.

The hinge order of the skeleton is the one joint order of the project. A hinge has its own drive. A coupling is a
rotation that a linkage or tendon drives together with a hinge, such as a finger joint; couplings have no place in the
joint order, and only forward kinematics needs their angles.

x points forward, y left, z up. Lengths are in metres, angles in radians.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import rotation_about

NO_SEGMENTS: frozenset[int] = frozenset()  # empty set of segment indices


@dataclass(frozen=True, eq=False)
class Capsule:
    """Cylinder with round ends on a segment, for collisions and inertia."""

    start: Floats  # (3,) [m] centre of the first end, in the segment
    end: Floats  # (3,) [m] centre of the second end, in the segment
    radius: float  # [m]


@dataclass(frozen=True, eq=False)
class Segment:
    """Rigid part, named after the H-Anim 1.1 joint at its origin."""

    name: str
    parent: str | None  # None: the world
    origin_in_parent: Floats  # (3,) [m]
    mass: float  # [kg] structure without servos
    capsules: tuple[Capsule, ...]


@dataclass(frozen=True, eq=False)
class Hinge:
    """Rotational joint with one degree of freedom and an MPEG-4 BAP name.

    The axes of the hinges of one segment pass through its origin or near it.
    """

    name: str
    segment: str
    axis: Floats  # (3,) unit vector in the segment, with the later hinges of the same segment at zero
    lower: float  # [rad]
    upper: float  # [rad]
    rest: float  # [rad]
    at: Floats = field(default_factory=lambda: sealed(np.zeros(3)))  # (3,) [m] point on the axis, in the segment


@dataclass(frozen=True, eq=False)
class Coupling:
    """Rotation coupled to a driver hinge: offset + ratio * angle."""

    name: str
    segment: str  # rotates about its origin, before the hinges of the same segment
    axis: Floats  # (3,) unit vector in the segment
    driver: int  # index of the driving hinge, in joint order
    ratio: float
    offset: float  # [rad]


@dataclass(frozen=True, eq=False)
class Frames:
    """Rotations and origins of all segments in the world."""

    rotations: Floats  # (..., s, 3, 3)
    origins: Floats  # (..., s, 3) [m]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Kinematic tree of segments and hinges, ordered from the root."""

    segments: tuple[Segment, ...]
    hinges: tuple[Hinge, ...]
    couplings: tuple[Coupling, ...] = ()

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Hinge names in joint order."""
        return tuple(hinge.name for hinge in self.hinges)

    @cached_property
    def lower(self) -> Floats:
        """Lower angle limits (n,) [rad]."""
        return sealed([hinge.lower for hinge in self.hinges])

    @cached_property
    def upper(self) -> Floats:
        """Upper angle limits (n,) [rad]."""
        return sealed([hinge.upper for hinge in self.hinges])

    @cached_property
    def rest(self) -> Floats:
        """Angles of the rest posture (n,) [rad]."""
        return sealed([hinge.rest for hinge in self.hinges])

    @cached_property
    def _joint_of(self) -> dict[str, int]:
        return {name: k for k, name in enumerate(self.names)}

    @cached_property
    def _segment_of(self) -> dict[str, int]:
        return {segment.name: k for k, segment in enumerate(self.segments)}

    @cached_property
    def axes(self) -> Floats:
        """Segment-frame unit axes (n + c, 3) of hinges and couplings."""
        return sealed(np.reshape([*(h.axis for h in self.hinges), *(c.axis for c in self.couplings)], (-1, 3)))

    @cached_property
    def _coupled(self) -> tuple[list[int], Floats, Floats]:
        """Driver indices, ratios (c,) and offsets (c,) [rad] of the couplings."""
        ratios, offsets = zip(*((coupling.ratio, coupling.offset) for coupling in self.couplings), strict=True)
        return [coupling.driver for coupling in self.couplings], sealed(ratios), sealed(offsets)

    @cached_property
    def rest_frames(self) -> Frames:
        """Frames of all segments in the rest posture."""
        return self.frames(self.rest)

    @cached_property
    def zero_frames(self) -> Frames:
        """Frames of all segments with all angles zero."""
        return self.frames(np.zeros(len(self.hinges)))

    @cached_property
    def steps(self) -> tuple[tuple[int, Floats, tuple[tuple[int, Floats | None], ...]], ...]:
        """Forward kinematics steps, one per segment.

        A step holds the parent (-1: world), the origin in the parent, and index and offset of each rotation.
        """
        return tuple(
            (
                -1 if segment.parent is None else self._segment_of[segment.parent],
                segment.origin_in_parent,
                (
                    *(
                        (k, None)
                        for k, coupling in enumerate(self.couplings, len(self.hinges))
                        if coupling.segment == segment.name
                    ),
                    *(
                        (k, hinge.at if hinge.at.any() else None)
                        for k, hinge in enumerate(self.hinges)
                        if hinge.segment == segment.name
                    ),
                ),
            )
            for segment in self.segments
        )

    def joint(self, name: str) -> int:
        """Return the index of a hinge in joint order."""
        return self._joint_of[name]

    def joints_of(self, segments: tuple[str, ...]) -> tuple[int, ...]:
        """Return the indices of the hinges of some segments, in joint order."""
        return tuple(k for k, hinge in enumerate(self.hinges) if hinge.segment in segments)

    def segment(self, name: str) -> int:
        """Return the index of a segment."""
        return self._segment_of[name]

    @lru_cache(maxsize=64)  # noqa: B019  a process has few skeletons and keeps them until it ends
    def segments_off_path(self, ends: frozenset[int]) -> frozenset[int]:
        """Return the indices of segments outside the paths from root to `ends`.

        Args:
            ends: indices of the segments at which the paths end; they count as on their path.
        """
        on_path = set[int]()
        for end in ends:
            segment = end
            while segment >= 0:
                on_path.add(segment)
                segment = self.steps[segment][0]
        return frozenset(range(len(self.segments))) - on_path

    def clamp(self, angles: Floats) -> Floats:
        """Clip angles (..., n) [rad] to the joint limits."""
        clamped: Floats = np.clip(angles, self.lower, self.upper)
        return clamped

    def with_couplings(self, angles: Floats) -> Floats:
        """Append the coupling angles to hinge angles.

        Args:
            angles: (..., n) [rad] of the hinges.

        Returns:
            (..., n + c) [rad].
        """
        if not self.couplings:
            return angles
        drivers, ratios, offsets = self._coupled
        return np.concatenate([angles, offsets + ratios * np.asarray(angles)[..., drivers]], axis=-1)

    def frames(self, angles: Floats, *, without: frozenset[int] = NO_SEGMENTS) -> Frames:
        """Compute the forward kinematics of all segments.

        Args:
            angles: (..., n) [rad] in joint order, one posture or any shape of them.
            without: unneeded segments with all their descendants; their frames are undefined.

        Returns:
            Rotation and origin of each segment in the world, with the leading shape of `angles`.
        """
        shape = (*np.shape(angles)[:-1], len(self.segments))
        rotations, origins = np.empty((*shape, 3, 3)), np.empty((*shape, 3))
        turn_matrices = rotation_about(self.axes, np.asarray(self.with_couplings(angles)))
        for k, (parent, origin, hinges) in enumerate(self.steps):
            if k in without:
                continue
            if parent < 0:
                rotation = np.broadcast_to(np.eye(3), (*shape[:-1], 3, 3))
                origins[..., k, :] = origin
            else:
                rotation = rotations[..., parent, :, :]
                origins[..., k, :] = origins[..., parent, :] + rotation @ origin
            for joint, offset in hinges:
                turned = rotation @ turn_matrices[..., joint, :, :]
                if offset is not None:
                    origins[..., k, :] += (rotation - turned) @ offset
                rotation = turned
            rotations[..., k, :, :] = rotation
        return Frames(sealed(rotations), sealed(origins))
