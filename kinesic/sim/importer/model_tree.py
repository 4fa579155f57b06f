"""A foreign robot as data: its hinges in one pose, at first that of its file, and what moves with each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import about
from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.mesh_file import Triangles

Transform = tuple[Floats, Floats]  # rotation (3, 3) and shift (3,) [m]

BASE = -1  # stands for the base where an index of a joint is asked


@dataclass(frozen=True)
class Follow:
    """How a hinge without a motor follows another one: its angle is offset + ratio times that one's."""

    driver: str  # name of a hinge
    ratio: float
    offset: float  # [rad]


@dataclass(frozen=True, eq=False)
class Joint:
    """One hinge; what the file does not say is None."""

    name: str
    parent: int  # index of the hinge before it, or BASE
    anchor: Floats  # (3,) [m] a point of its axis in the world
    axis: Floats  # (3,) unit, in the world
    zero: float  # [rad] its angle in this pose
    lower: float | None  # [rad]
    upper: float | None  # [rad]
    effort: float | None  # [Nm]
    speed: float | None  # [rad/s]
    gain: float | None  # [Nm/rad] of its position actuator
    armature: float | None  # [kg m^2]
    friction: float | None  # [Nm]
    damping: float | None  # [Nm s/rad]
    follows: Follow | None = None  # of one that no motor turns


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles that are seen of a part."""

    mesh: Triangles  # in the world
    dark: bool


@dataclass(frozen=True, eq=False)
class ModelPart:
    """What moves with one hinge, up to the next: bodies on joints that are not motorised hinges belong to it."""

    mass: float  # [kg]
    centre: Floats  # (3,) [m] of mass, in the world
    shapes: tuple[Capsule, ...]  # in the world
    surfaces: tuple[Surface, ...] = ()


@dataclass(frozen=True, eq=False)
class Tree:
    """Hinges with parents first; `parts[k]` moves with `joints[k]`."""

    name: str
    joints: tuple[Joint, ...]
    parts: tuple[ModelPart, ...]
    base: ModelPart
    left_out: tuple[str, ...] = ()  # what of the file has no place here, in words

    @cached_property
    def children(self) -> dict[int, tuple[int, ...]]:
        """Index of a hinge (or BASE) -> the hinges that hang on it."""
        found: dict[int, tuple[int, ...]] = dict.fromkeys(range(BASE, len(self.joints)), ())
        for k, joint in enumerate(self.joints):
            found[joint.parent] += (k,)
        return found

    def way(self, joint: int) -> tuple[int, ...]:
        """Lists the hinges from the base to one, itself included."""
        row: list[int] = []
        while joint != BASE:
            row.append(joint)
            joint = self.joints[joint].parent
        return tuple(reversed(row))

    def below(self, joint: int) -> tuple[int, ...]:
        """Lists a hinge and all that hang on it."""
        return (joint, *(k for child in self.children[joint] for k in self.below(child)))

    def lump(self, parts: Sequence[int]) -> ModelPart:
        """Joins several parts to one; BASE stands for the base."""
        rows = [self.base if k == BASE else self.parts[k] for k in parts]
        mass = sum(row.mass for row in rows)
        weighted = sum((row.mass * row.centre for row in rows), np.zeros(3))
        centre = weighted / mass if mass > 0 else rows[0].centre
        shapes = tuple(shape for row in rows for shape in row.shapes)
        return ModelPart(mass, sealed(centre), shapes, tuple(surface for row in rows for surface in row.surfaces))

    def moved(self, rotation: Floats, shift: Floats) -> "Tree":
        """Turns the whole robot by (3, 3), then shifts it by (3,) [m]."""
        motion = dict.fromkeys(range(BASE, len(self.joints)), (rotation, shift))
        return self._with(motion, motion, {})

    def turned(self, turns: Mapping[int, float]) -> "Tree":
        """Brings the robot into another pose: hinge -> [rad] from this one."""
        before: dict[int, Transform] = {}
        after: dict[int, Transform] = {BASE: (np.eye(3), np.zeros(3))}
        for k, joint in enumerate(self.joints):
            rotation, shift = before[k] = after[joint.parent]
            turn = about(joint.axis, turns.get(k, 0.0))
            after[k] = rotation @ turn, shift + rotation @ (joint.anchor - turn @ joint.anchor)
        return self._with(before, after, turns)

    def _with(
        self, before: Mapping[int, Transform], after: Mapping[int, Transform], turns: Mapping[int, float]
    ) -> "Tree":
        """Hinges moved as they are before they turn, parts as they are after."""
        joints = tuple(
            replace(
                joint,
                anchor=_point(joint.anchor, before[k]),
                axis=sealed(before[k][0] @ joint.axis),
                zero=joint.zero + turns.get(k, 0.0),
            )
            for k, joint in enumerate(self.joints)
        )
        parts = tuple(_moved(part, after[k]) for k, part in enumerate(self.parts))
        return replace(self, joints=joints, parts=parts, base=_moved(self.base, after[BASE]))


def _point(point: Floats, motion: Transform) -> Floats:
    return sealed(motion[0] @ point + motion[1])


def _moved(part: ModelPart, motion: Transform) -> ModelPart:
    shapes = tuple(Capsule(_point(s.start, motion), _point(s.end, motion), s.radius) for s in part.shapes)
    return ModelPart(part.mass, _point(part.centre, motion), shapes, tuple(_turned(s, motion) for s in part.surfaces))


def _turned(surface: Surface, motion: Transform) -> Surface:
    places = surface.mesh.vertices @ motion[0].T + motion[1]
    return replace(surface, mesh=Triangles(sealed(places), surface.mesh.corners))
