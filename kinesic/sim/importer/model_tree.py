"""Tree of an imported robot's hinges and moving parts in one pose."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import rotation_about
from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.mesh_file import Triangles

Transform = tuple[Floats, Floats]  # rotation (3, 3) and shift (3,) [m]

BASE_INDEX = -1  # index of the base among joints and parts


@dataclass(frozen=True)
class Follow:
    """Linear coupling of one hinge to another that drives it.

    angle = offset + ratio * driver angle
    """

    driver: str  # name of the driving hinge
    ratio: float  # angle per angle of the driver
    offset: float  # [rad]


@dataclass(frozen=True, eq=False)
class Joint:
    """Hinge of an imported robot.

    Values missing in the file are None.
    """

    name: str
    parent: int  # index of the previous hinge, or BASE_INDEX
    anchor: Floats  # (3,) [m] point on the axis in the world
    axis: Floats  # (3,) unit vector in the world
    zero: float  # [rad] joint angle in this pose
    lower: float | None  # [rad] lower limit
    upper: float | None  # [rad] upper limit
    effort: float | None  # [Nm] torque limit
    speed: float | None  # [rad/s] velocity limit
    gain: float | None  # [Nm/rad] gain of the position actuator
    armature: float | None  # [kg m^2]
    friction: float | None  # [Nm] Coulomb friction
    damping: float | None  # [Nm s/rad]
    follows: Follow | None = None  # coupling of a hinge without motor


@dataclass(frozen=True, eq=False)
class Surface:
    """Visible mesh of a part."""

    mesh: Triangles  # in world coordinates
    dark: bool  # whether it is drawn dark


@dataclass(frozen=True, eq=False)
class ModelPart:
    """Rigid part between a hinge and the next hinges.

    Bodies on joints that the tree does not contain, which are fixed, belong to it.
    """

    mass: float  # [kg]
    centre: Floats  # (3,) [m] centre of mass in the world
    shapes: tuple[Capsule, ...]  # in the world
    surfaces: tuple[Surface, ...] = ()


@dataclass(frozen=True, eq=False)
class Tree:
    """Tree of hinges, parents first, each with the part it moves."""

    name: str
    joints: tuple[Joint, ...]
    parts: tuple[ModelPart, ...]
    base: ModelPart
    left_out: tuple[str, ...] = ()  # notes on parts of the file that are not imported

    @cached_property
    def children(self) -> dict[int, tuple[int, ...]]:
        """Indices of the child hinges of each hinge and of BASE_INDEX."""
        result: dict[int, tuple[int, ...]] = dict.fromkeys(range(BASE_INDEX, len(self.joints)), ())
        for k, joint in enumerate(self.joints):
            result[joint.parent] += (k,)
        return result

    def path_from_base(self, joint: int) -> tuple[int, ...]:
        """List the hinge indices from the base up to a hinge, inclusive."""
        row: list[int] = []
        while joint != BASE_INDEX:
            row.append(joint)
            joint = self.joints[joint].parent
        return tuple(reversed(row))

    def below(self, joint: int) -> tuple[int, ...]:
        """List the indices of a hinge and of all its descendants."""
        return (joint, *(k for child in self.children[joint] for k in self.below(child)))

    def without(self, held: Collection[int]) -> "Tree":
        """Return the tree with some hinges held in this pose.

        Their parts belong to the part of the previous hinge.
        """
        kept = [k for k in range(len(self.joints)) if k not in held]

        def owner(k: int) -> int:
            while k in held:
                k = self.joints[k].parent
            return k

        indices = {BASE_INDEX: BASE_INDEX} | {k: place for place, k in enumerate(kept)}
        rows: dict[int, list[int]] = {k: [k] for k in (BASE_INDEX, *kept)}
        for k in sorted(held):
            rows[owner(k)].append(k)
        joints = tuple(replace(self.joints[k], parent=indices[owner(self.joints[k].parent)]) for k in kept)
        parts = tuple(self.merge_parts(rows[k]) for k in kept)
        notes = tuple(f"{self.joints[k].name} is held, as requested" for k in sorted(held))
        return replace(
            self, joints=joints, parts=parts, base=self.merge_parts(rows[BASE_INDEX]), left_out=(*self.left_out, *notes)
        )

    def merge_parts(self, parts: Sequence[int]) -> ModelPart:
        """Merge several rigid parts into one.

        BASE_INDEX is the index of the base.
        """
        rows = [self.base if k == BASE_INDEX else self.parts[k] for k in parts]
        mass = sum(row.mass for row in rows)
        weighted = sum((row.mass * row.centre for row in rows), np.zeros(3))
        centre = weighted / mass if mass > 0 else rows[0].centre
        shapes = tuple(shape for row in rows for shape in row.shapes)
        return ModelPart(mass, sealed(centre), shapes, tuple(surface for row in rows for surface in row.surfaces))

    def moved(self, rotation: Floats, shift: Floats) -> "Tree":
        """Return the whole robot rotated, then translated.

        Args:
            rotation: (3, 3).
            shift: (3,) [m].
        """
        motion = dict.fromkeys(range(BASE_INDEX, len(self.joints)), (rotation, shift))
        return self._transform(motion, motion, {})

    def turned(self, turns: Mapping[int, float]) -> "Tree":
        """Return the robot with its hinges rotated.

        Args:
            turns: Hinge index -> [rad] rotation from this pose.
        """
        before: dict[int, Transform] = {}
        after: dict[int, Transform] = {BASE_INDEX: (np.eye(3), np.zeros(3))}
        for k, joint in enumerate(self.joints):
            rotation, shift = before[k] = after[joint.parent]
            turn = rotation_about(joint.axis, turns.get(k, 0.0))
            after[k] = rotation @ turn, shift + rotation @ (joint.anchor - turn @ joint.anchor)
        return self._transform(before, after, turns)

    def _transform(
        self, before: Mapping[int, Transform], after: Mapping[int, Transform], turns: Mapping[int, float]
    ) -> "Tree":
        """Return the tree with hinges and parts transformed.

        Args:
            before: Motion of each hinge's axis.
            after: Motion of each hinge's part, including the rotation of the hinge.
            turns: Hinge index -> [rad] rotation.
        """
        joints = tuple(
            replace(
                joint,
                anchor=_transform_point(joint.anchor, before[k]),
                axis=sealed(before[k][0] @ joint.axis),
                zero=joint.zero + turns.get(k, 0.0),
            )
            for k, joint in enumerate(self.joints)
        )
        parts = tuple(_transform_part(part, after[k]) for k, part in enumerate(self.parts))
        return replace(self, joints=joints, parts=parts, base=_transform_part(self.base, after[BASE_INDEX]))


def _transform_point(point: Floats, motion: Transform) -> Floats:
    return sealed(motion[0] @ point + motion[1])


def _transform_part(part: ModelPart, motion: Transform) -> ModelPart:
    shapes = tuple(
        Capsule(_transform_point(s.start, motion), _transform_point(s.end, motion), s.radius) for s in part.shapes
    )
    return ModelPart(
        part.mass,
        _transform_point(part.centre, motion),
        shapes,
        tuple(_transform_surface(s, motion) for s in part.surfaces),
    )


def _transform_surface(surface: Surface, motion: Transform) -> Surface:
    places = surface.mesh.vertices @ motion[0].T + motion[1]
    return replace(surface, mesh=Triangles(sealed(places), surface.mesh.corners))
