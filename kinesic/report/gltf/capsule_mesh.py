"""Triangle meshes of capsules."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Capsule

AXIS_SLICES = 20  # facets of a capsule mesh around its axis
CAP_STACKS = 5  # rings of each hemisphere of a capsule mesh


@dataclass(frozen=True, eq=False)
class ClosedMesh:
    """Triangle mesh of a closed surface."""

    positions: Floats  # (v, 3) [m]
    normals: Floats  # (v, 3) unit, outward
    corners: NDArray[np.intp]  # (t, 3) anticlockwise from outside


def capsule_mesh(capsule: Capsule) -> ClosedMesh:
    """Return the triangle mesh of a capsule in its segment's frame."""
    axis = capsule.end - capsule.start
    length = float(np.linalg.norm(axis))
    up = axis / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    side = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    side /= np.linalg.norm(side)
    across = np.cross(up, side)
    rise = np.linspace(-np.pi / 2, np.pi / 2, 2 * CAP_STACKS)
    turn = np.arange(AXIS_SLICES) * 2 * np.pi / AXIS_SLICES
    ring = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * across  # (slices, 3)
    normals = np.cos(rise)[:, None, None] * ring + np.sin(rise)[:, None, None] * up
    centres = np.where(rise[:, None] < 0.0, capsule.start, capsule.end)
    positions = centres[:, None, :] + capsule.radius * normals
    low = np.arange(2 * CAP_STACKS - 1)[:, None] * AXIS_SLICES + np.arange(AXIS_SLICES)
    after = np.arange(2 * CAP_STACKS - 1)[:, None] * AXIS_SLICES + (np.arange(AXIS_SLICES) + 1) % AXIS_SLICES
    quads = np.stack([low, after, after + AXIS_SLICES, low + AXIS_SLICES], axis=-1).reshape(-1, 4)
    first, second = (
        quads[AXIS_SLICES:, [0, 1, 2]],
        quads[:-AXIS_SLICES, [0, 2, 3]],
    )  # at the poles one of two has no area
    corners = np.concatenate([first, second])
    return ClosedMesh(positions.reshape(-1, 3), normals.reshape(-1, 3), corners)


def join_surfaces(meshes: list[ClosedMesh]) -> ClosedMesh:
    """Join triangle meshes into one."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return ClosedMesh(
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.corners + start for mesh, start in zip(meshes, starts, strict=False)]),
    )
