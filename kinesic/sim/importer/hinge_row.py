"""A row of hinges that turns: lines in space and what is fixed to them."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import UNTURNED, about
from kinesic.sim.importer.model_tree import Tree

NOWHERE = np.zeros(3)


@dataclass(frozen=True, eq=False)
class HingeRow:
    """Hinges from the base outward, in one pose."""

    anchors: Floats  # (k, 3) [m]
    axes: Floats  # (k, 3) unit
    centre: Floats  # (3,) [m] of mass of what the last hinge moves, fingers included

    @classmethod
    def of(cls, tree: Tree, joints: Sequence[int]) -> "HingeRow":
        """Takes a limb in the pose of the file."""
        return cls(
            sealed([tree.joints[k].anchor for k in joints]),
            sealed([tree.joints[k].axis for k in joints]),
            tree.lump(tree.below(joints[-1])).centre,
        )

    def turned(self, angles: Floats) -> "HingeRow":
        """Turns each hinge of the limb by (k,) [rad]."""
        motion = self.motion(angles)
        rotations = np.array([UNTURNED, *(rotation for rotation, _ in motion[:-1])])
        shifts = np.array([NOWHERE, *(shift for _, shift in motion[:-1])])
        return HingeRow(
            sealed(_each(rotations, self.anchors) + shifts),
            sealed(_each(rotations, self.axes)),
            sealed(motion[-1][0] @ self.centre + motion[-1][1]),
        )

    def motion(self, angles: Floats) -> list[tuple[Floats, Floats]]:
        """Finds rotation (3, 3) and shift (3,) [m] of what each hinge moves, from this pose."""
        rotation, shift = UNTURNED, NOWHERE
        turns = about(self.axes, angles)
        found = []
        for turn, moved in zip(turns, self.anchors - _each(turns, self.anchors), strict=True):
            shift = shift + rotation @ moved
            rotation = rotation @ turn
            found.append((rotation, shift))
        return found


def common_point(anchors: Floats, axes: Floats, near: Floats, pull: float = 1e-3) -> Floats:
    """Finds the point (3,) [m] nearest to all lines; where they leave it open, nearest to a point."""
    across = UNTURNED - axes[:, :, None] * axes[:, None, :]
    matrix = sum(across, pull * UNTURNED)
    right = sum(_each(across, anchors), pull * near)
    return sealed(np.linalg.solve(matrix, right))


def distances(point: Floats, anchors: Floats, axes: Floats) -> Floats:
    """Measures the distance [m] of a point from each line, (k,)."""
    found: Floats = np.linalg.norm(_cross(point - anchors, axes), axis=1)
    return found


def foot(point: Floats, anchor: Floats, axis: Floats) -> Floats:
    """Finds the point (3,) [m] of a line that is nearest to a point."""
    return sealed(anchor + axis * (axis @ (point - anchor)))


def nearest_to_line(anchor: Floats, axis: Floats, other: Floats, direction: Floats) -> Floats:
    """Finds the point (3,) [m] of a line that is nearest to another line; its anchor where they are parallel."""
    across = _cross(axis, direction)
    size = float(across @ across)
    if size < 1e-6:
        return foot(other, anchor, axis)
    along = float(_cross(other - anchor, direction) @ across) / size
    return sealed(anchor + along * axis)


def unit_vector(vector: Floats) -> Floats:
    """Scales a vector to length 1; zero stays zero."""
    length = sqrt(vector @ vector)
    return vector / length if length > 0 else vector


def _each(matrices: Floats, vectors: Floats) -> Floats:
    """(k, 3) products of (k, 3, 3) and (k, 3)."""
    found: Floats = (matrices @ vectors[:, :, None])[:, :, 0]
    return found


def _cross(one: Floats, other: Floats) -> Floats:
    """(3,) or (k, 3) as `np.cross`, which spends ten times as long on choosing axes."""
    (a, b, c), (d, e, f) = one.T, other.T
    return np.array([b * f - c * e, c * d - a * f, a * e - b * d]).T
