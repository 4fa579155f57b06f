"""A row of hinges that turns: lines in space and what is fixed to them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import about
from kinesic.sim.foreign.tree import Tree


@dataclass(frozen=True, eq=False)
class Limb:
    """Hinges from the base outward, in one pose."""

    anchors: Floats  # (k, 3) [m]
    axes: Floats  # (k, 3) unit
    centre: Floats  # (3,) [m] of mass of what the last hinge moves, fingers included

    @classmethod
    def of(cls, tree: Tree, joints: Sequence[int]) -> "Limb":
        """The limb in the pose of the file."""
        return cls(
            sealed([tree.joints[k].anchor for k in joints]),
            sealed([tree.joints[k].axis for k in joints]),
            tree.lump(tree.below(joints[-1])).centre,
        )

    def turned(self, angles: Floats) -> "Limb":
        """The same limb with each hinge turned by (k,) [rad]."""
        motion = self.motion(angles)
        before = [(np.eye(3), np.zeros(3)), *motion[:-1]]
        return Limb(
            sealed([r @ p + t for (r, t), p in zip(before, self.anchors, strict=True)]),
            sealed([r @ x for (r, _), x in zip(before, self.axes, strict=True)]),
            sealed(motion[-1][0] @ self.centre + motion[-1][1]),
        )

    def motion(self, angles: Floats) -> list[tuple[Floats, Floats]]:
        """Rotation (3, 3) and shift (3,) [m] of what each hinge moves, from this pose."""
        rotation, shift = np.eye(3), np.zeros(3)
        found = []
        for anchor, axis, angle in zip(self.anchors, self.axes, angles, strict=True):
            turn = about(axis, angle)
            shift = shift + rotation @ (anchor - turn @ anchor)
            rotation = rotation @ turn
            found.append((rotation, shift))
        return found


def common_point(anchors: Floats, axes: Floats, near: Floats, pull: float = 1e-3) -> Floats:
    """(3,) [m] nearest to all lines; where they leave it open, nearest to a point."""
    matrix, right = pull * np.eye(3), pull * near
    for anchor, axis in zip(anchors, axes, strict=True):
        across = np.eye(3) - np.outer(axis, axis)
        matrix, right = matrix + across, right + across @ anchor
    return sealed(np.linalg.solve(matrix, right))


def distances(point: Floats, anchors: Floats, axes: Floats) -> Floats:
    """(k,) [m] from a point to each line."""
    found: Floats = np.linalg.norm(_cross(point - anchors, axes), axis=1)
    return found


def foot(point: Floats, anchor: Floats, axis: Floats) -> Floats:
    """(3,) [m] the point of a line that is nearest to a point."""
    return sealed(anchor + axis * (axis @ (point - anchor)))


def nearest_to_line(anchor: Floats, axis: Floats, other: Floats, direction: Floats) -> Floats:
    """(3,) [m] the point of a line that is nearest to another line; to its anchor where they are parallel."""
    across = _cross(axis, direction)
    size = float(across @ across)
    if size < 1e-6:
        return foot(other, anchor, axis)
    along = float(_cross(other - anchor, direction) @ across) / size
    return sealed(anchor + along * axis)


def unit(vector: Floats) -> Floats:
    """The vector in length 1; zero stays zero."""
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector


def _cross(one: Floats, other: Floats) -> Floats:
    """(3,) or (k, 3) as `np.cross`, which spends ten times as long on choosing axes."""
    (a, b, c), (d, e, f) = one.T, other.T
    return np.array([b * f - c * e, c * d - a * f, a * e - b * d]).T
