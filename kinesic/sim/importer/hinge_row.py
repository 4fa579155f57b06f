"""Serial chain of hinges as lines in space, with its forward kinematics."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import IDENTITY_ROTATION, rotation_about
from kinesic.sim.importer.model_tree import ModelPart, Tree

ZERO_VECTOR = np.zeros(3)  # [m] origin of a coordinate frame


@dataclass(frozen=True, eq=False)
class HingeRow:
    """Hinges of a limb from the base outwards, in one pose."""

    anchors: Floats  # (k, 3) [m] points on the axes
    axes: Floats  # (k, 3) unit vectors of the axes
    centre: Floats  # (3,) [m] centre of mass of the parts moved by the last hinge, including fingers
    tip: Floats | None = None  # (3,) [m] point of these parts farthest from the last anchor; None without shapes

    @classmethod
    def of(cls, tree: Tree, joints: Sequence[int]) -> "HingeRow":
        """Return the hinge lines of a limb in the tree's current pose."""
        last = tree.merge_parts(tree.below(joints[-1]))
        return cls(
            sealed([tree.joints[k].anchor for k in joints]),
            sealed([tree.joints[k].axis for k in joints]),
            last.centre,
            _find_tip(last, tree.joints[joints[-1]].anchor),
        )

    def turned(self, angles: Floats) -> "HingeRow":
        """Return the limb with each hinge rotated by angles (k,) [rad]."""
        motion = self.motion(angles)
        rotations = np.array([IDENTITY_ROTATION, *(rotation for rotation, _ in motion[:-1])])
        shifts = np.array([ZERO_VECTOR, *(shift for _, shift in motion[:-1])])
        return HingeRow(
            sealed(_multiply(rotations, self.anchors) + shifts),
            sealed(_multiply(rotations, self.axes)),
            sealed(motion[-1][0] @ self.centre + motion[-1][1]),
            None if self.tip is None else sealed(motion[-1][0] @ self.tip + motion[-1][1]),
        )

    def motion(self, angles: Floats) -> list[tuple[Floats, Floats]]:
        """Compute the rigid motion of the links for hinge rotations (k,) [rad].

        Returns:
            Rotation (3, 3) and translation (3,) [m] of the link after each hinge, from this pose.
        """
        rotation, shift = IDENTITY_ROTATION, ZERO_VECTOR
        turns = rotation_about(self.axes, angles)
        result = []
        for turn, translation in zip(turns, self.anchors - _multiply(turns, self.anchors), strict=True):
            shift = shift + rotation @ translation
            rotation = rotation @ turn
            result.append((rotation, shift))
        return result


def _find_tip(part: ModelPart, anchor: Floats) -> Floats | None:
    """Return the centre of a part's far end (3,) [m]."""
    points = list_surface_points(part)
    if not len(points):
        return None
    away = unit_vector(part.centre - anchor)
    reach = (points - anchor) @ away
    return sealed(anchor + away * float(reach.max())) if away.any() else None


def list_surface_points(part: ModelPart) -> Floats:
    """Return surface points (n, 3) [m] of a part in the world.

    The points come from meshes, or from primitive shapes without meshes.
    """
    if part.surfaces:
        return sealed(np.concatenate([surface.mesh.vertices for surface in part.surfaces]))
    directions = np.concatenate([np.eye(3), -np.eye(3)])
    ends = [(end, shape.radius) for shape in part.shapes for end in (shape.start, shape.end)]
    return sealed(np.concatenate([np.zeros((0, 3)), *(end + radius * directions for end, radius in ends)]))


def find_common_point(anchors: Floats, axes: Floats, near: Floats, pull: float = 1e-3) -> Floats:
    """Compute the least-squares nearest point (3,) [m] to all lines.

    The point nearest to `near` is chosen if the lines leave it undetermined.
    """
    projection = IDENTITY_ROTATION - axes[:, :, None] * axes[:, None, :]
    matrix = sum(projection, pull * IDENTITY_ROTATION)
    right = sum(_multiply(projection, anchors), pull * near)
    return sealed(np.linalg.solve(matrix, right))


def distances(point: Floats, anchors: Floats, axes: Floats) -> Floats:
    """Compute the distance (k,) [m] of a point from each line."""
    result: Floats = np.linalg.norm(_cross(point - anchors, axes), axis=1)
    return result


def foot(point: Floats, anchor: Floats, axis: Floats) -> Floats:
    """Project a point onto a line, (3,) [m]."""
    return sealed(anchor + axis * (axis @ (point - anchor)))


def find_nearest_on_line(anchor: Floats, axis: Floats, second: Floats, direction: Floats) -> Floats:
    """Compute the point (3,) [m] of a line nearest to another line.

    For parallel lines, the point nearest to the anchor of the other line.
    """
    projection = _cross(axis, direction)
    size = float(projection @ projection)
    if size < 1e-6:
        return foot(second, anchor, axis)
    along = float(_cross(second - anchor, direction) @ projection) / size
    return sealed(anchor + along * axis)


def unit_vector(vector: Floats) -> Floats:
    """Scale a vector to length 1, except a zero vector."""
    length = sqrt(vector @ vector)
    return vector / length if length > 0 else vector


def _multiply(matrices: Floats, vectors: Floats) -> Floats:
    """Multiply k matrices (k, 3, 3) by k vectors (k, 3)."""
    result: Floats = (matrices @ vectors[:, :, None])[:, :, 0]
    return result


def _cross(first: Floats, second: Floats) -> Floats:
    """Compute cross products of (3,) or (k, 3) vectors.

    Ten times as fast as `np.cross`, which checks its axes.
    """
    (a, b, c), (d, e, f) = first.T, second.T
    return np.array([b * f - c * e, c * d - a * f, a * e - b * d]).T
