"""Capsules as triangles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Capsule

SLICES, STACKS = 20, 5  # round the axis, and from its end to where the cylinder begins


@dataclass(frozen=True, eq=False)
class Triangles:
    """A closed surface."""

    positions: Floats  # (v, 3) [m]
    normals: Floats  # (v, 3) unit, outward
    corners: NDArray[np.intp]  # (t, 3) anticlockwise from outside


def capsule_mesh(capsule: Capsule) -> Triangles:
    """Makes the surface of a capsule, in its segment."""
    axis = capsule.end - capsule.start
    length = float(np.linalg.norm(axis))
    up = axis / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    side = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    side /= np.linalg.norm(side)
    across = np.cross(up, side)
    rise = np.linspace(-np.pi / 2, np.pi / 2, 2 * STACKS)
    turn = np.arange(SLICES) * 2 * np.pi / SLICES
    ring = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * across  # (slices, 3)
    normals = np.cos(rise)[:, None, None] * ring + np.sin(rise)[:, None, None] * up
    centres = np.where(rise[:, None] < 0.0, capsule.start, capsule.end)
    positions = centres[:, None, :] + capsule.radius * normals
    low = np.arange(2 * STACKS - 1)[:, None] * SLICES + np.arange(SLICES)
    after = np.arange(2 * STACKS - 1)[:, None] * SLICES + (np.arange(SLICES) + 1) % SLICES
    quads = np.stack([low, after, after + SLICES, low + SLICES], axis=-1).reshape(-1, 4)
    first, second = quads[SLICES:, [0, 1, 2]], quads[:-SLICES, [0, 2, 3]]  # at the poles one of two has no area
    corners = np.concatenate([first, second])
    return Triangles(positions.reshape(-1, 3), normals.reshape(-1, 3), corners)


def join_surfaces(meshes: list[Triangles]) -> Triangles:
    """Puts surfaces into one."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return Triangles(
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.corners + start for mesh, start in zip(meshes, starts, strict=False)]),
    )
