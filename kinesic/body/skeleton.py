"""The robot as a tree of segments joined by hinges; its hinge order is the one joint order of the project.

A hinge has a drive of its own. Linkages and tendons turn further ones along with it, such as the joints of a finger:
these are couplings, no hinges, and have no place in the joint order. Forward kinematics alone asks how they stand.

x points forward, y left, z up. Every length is in metres, every angle in radians.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import about

NONE: frozenset[int] = frozenset()


@dataclass(frozen=True, eq=False)
class Capsule:
    """A cylinder with round ends, fixed to a segment: its shape for collisions, and where its mass lies."""

    start: Floats  # (3,) [m] in the segment
    end: Floats  # (3,) [m] in the segment
    radius: float  # [m]


@dataclass(frozen=True, eq=False)
class Segment:
    """One rigid part, named after its H-Anim 1.1 joint; its hinges turn about its origin."""

    name: str
    parent: str | None  # None: fixed to the world
    origin_in_parent: Floats  # (3,) [m]
    mass: float  # [kg] structure only, servos add their own
    capsules: tuple[Capsule, ...]


@dataclass(frozen=True, eq=False)
class Hinge:
    """One degree of freedom, with an MPEG-4 BAP name; hinges of one segment share its origin, or pass near it."""

    name: str
    segment: str
    axis: Floats  # (3,) unit vector in the segment, before later hinges of the same segment turn
    lower: float  # [rad]
    upper: float  # [rad]
    rest: float  # [rad]
    at: Floats = field(default_factory=lambda: sealed(np.zeros(3)))  # (3,) [m] in the segment: the axis passes there


@dataclass(frozen=True, eq=False)
class Coupling:
    """A turn without a drive, which follows that of a hinge: offset + ratio * its angle."""

    name: str
    segment: str  # about whose origin it turns, before hinges of the same segment
    axis: Floats  # (3,) unit vector in the segment
    driver: int  # the hinge that it follows, in joint order
    ratio: float
    offset: float  # [rad]


@dataclass(frozen=True, eq=False)
class Frames:
    """Where every segment is, in the world."""

    rotations: Floats  # (..., s, 3, 3)
    origins: Floats  # (..., s, 3) [m]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Segments with parents first, hinges from root to tip."""

    segments: tuple[Segment, ...]
    hinges: tuple[Hinge, ...]
    couplings: tuple[Coupling, ...] = ()

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Hinge names in joint order."""
        return tuple(hinge.name for hinge in self.hinges)

    @cached_property
    def lower(self) -> Floats:
        """(n,) [rad]."""
        return sealed([hinge.lower for hinge in self.hinges])

    @cached_property
    def upper(self) -> Floats:
        """(n,) [rad]."""
        return sealed([hinge.upper for hinge in self.hinges])

    @cached_property
    def rest(self) -> Floats:
        """(n,) [rad]."""
        return sealed([hinge.rest for hinge in self.hinges])

    @cached_property
    def _joint_of(self) -> dict[str, int]:
        return {name: k for k, name in enumerate(self.names)}

    @cached_property
    def _segment_of(self) -> dict[str, int]:
        return {segment.name: k for k, segment in enumerate(self.segments)}

    @cached_property
    def axes(self) -> Floats:
        """(n + c, 3) of all turns: the hinges, then the couplings."""
        return sealed(np.reshape([*(h.axis for h in self.hinges), *(c.axis for c in self.couplings)], (-1, 3)))

    @cached_property
    def _coupled(self) -> tuple[list[int], Floats, Floats]:
        """The drivers, ratios (c,) and offsets (c,) [rad] of the couplings."""
        ratios, offsets = zip(*((coupling.ratio, coupling.offset) for coupling in self.couplings), strict=True)
        return [coupling.driver for coupling in self.couplings], sealed(ratios), sealed(offsets)

    @cached_property
    def resting(self) -> Frames:
        """Where every segment is at rest."""
        return self.frames(self.rest)

    @cached_property
    def straight(self) -> Frames:
        """Where every segment is with all angles zero."""
        return self.frames(np.zeros(len(self.hinges)))

    @cached_property
    def steps(self) -> tuple[tuple[int, Floats, tuple[tuple[int, Floats | None], ...]], ...]:
        """Per segment: parent (-1: world), origin in the parent, and the indices and offsets of its turns."""
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
        """Finds the index of a hinge in joint order."""
        return self._joint_of[name]

    def joints_of(self, segments: tuple[str, ...]) -> tuple[int, ...]:
        """Finds the indices of the hinges that move these segments, in joint order."""
        return tuple(k for k, hinge in enumerate(self.hinges) if hinge.segment in segments)

    def segment(self, name: str) -> int:
        """Finds the index of a segment."""
        return self._segment_of[name]

    @lru_cache(maxsize=64)  # noqa: B019  the few skeletons of a process live as long as it
    def beside(self, ends: frozenset[int]) -> frozenset[int]:
        """Finds the segments that carry none of some segments, and are none of them."""
        carrying = set[int]()
        for end in ends:
            segment = end
            while segment >= 0:
                carrying.add(segment)
                segment = self.steps[segment][0]
        return frozenset(range(len(self.segments))) - carrying

    def clamp(self, angles: Floats) -> Floats:
        """Finds the nearest angles inside the ranges, for (..., n) [rad]."""
        clamped: Floats = np.clip(angles, self.lower, self.upper)
        return clamped

    def turns(self, angles: Floats) -> Floats:
        """Adds to the angles (..., n) [rad] of the hinges those of the couplings: (..., n + c) [rad]."""
        if not self.couplings:
            return angles
        drivers, ratios, offsets = self._coupled
        return np.concatenate([angles, offsets + ratios * np.asarray(angles)[..., drivers]], axis=-1)

    def frames(self, angles: Floats, *, without: frozenset[int] = NONE) -> Frames:
        """Solves the forward kinematics.

        Args:
            angles: (..., n) [rad] in joint order, one posture or any shape of them.
            without: segments that nobody asks for, with all that hang on them; their frames are anything.

        Returns:
            Rotation and origin of each segment in the world, with the leading shape of `angles`.
        """
        shape = (*np.shape(angles)[:-1], len(self.segments))
        rotations, origins = np.empty((*shape, 3, 3)), np.empty((*shape, 3))
        turns = about(self.axes, np.asarray(self.turns(angles)))
        for k, (parent, origin, hinges) in enumerate(self.steps):
            if k in without:
                continue
            if parent < 0:
                rotation = np.broadcast_to(np.eye(3), (*shape[:-1], 3, 3))
                origins[..., k, :] = origin
            else:
                rotation = rotations[..., parent, :, :]
                origins[..., k, :] = origins[..., parent, :] + rotation @ origin
            for joint, aside in hinges:
                turned = rotation @ turns[..., joint, :, :]
                if aside is not None:
                    origins[..., k, :] += (rotation - turned) @ aside
                rotation = turned
            rotations[..., k, :, :] = rotation
        return Frames(sealed(rotations), sealed(origins))
