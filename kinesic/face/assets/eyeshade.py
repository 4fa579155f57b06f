"""An eyeshade: a translucent brim on the forehead, for light that comes from above."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.mesh import Mesh

AXIS = -1.2  # how far in front of the eyes the axis is that the brim goes round; lengths are distances between the eyes
HEIGHT = 1.02  # of its inner edge over the eyes
BAND = 0.25  # how far over and under that the forehead is looked at
OFF = 0.03  # from the skin
LENGTH = 0.95  # how far it stands out in the middle
DROOP = 0.30  # how much lower its outer edge is, in lengths
ASIDE_DEG = 68.0  # to either side
AROUND, ACROSS = 48, 6  # faces


@dataclass(frozen=True, eq=False)
class Eyeshade:
    """A sheet of triangles in the head's frame, seen from both sides."""

    positions: Floats  # (v, 3) [m]
    normals: Floats  # (v, 3) unit, upward
    triangles: NDArray[np.int32]  # (t, 3)


def eyeshade(mesh: Mesh) -> Eyeshade:
    """Makes the brim that fits a head at rest."""
    unit = mesh.eyes[0, 1] - mesh.eyes[1, 1]
    angles = np.radians(np.linspace(-ASIDE_DEG, ASIDE_DEG, AROUND + 1))[:, None]
    inner = _forehead(mesh.positions[mesh.vertices("skin")] / unit, angles[:, 0])[:, None] + OFF
    out = LENGTH * np.sqrt(np.clip(np.cos(angles * 90.0 / ASIDE_DEG), 0.02, 1.0)) * np.linspace(0.0, 1.0, ACROSS + 1)
    radius = inner + out
    points = np.stack([AXIS + radius * np.cos(angles), radius * np.sin(angles), HEIGHT - DROOP * out], axis=-1) * unit
    along, across = np.gradient(points, axis=0), np.gradient(points, axis=1)
    normals = np.cross(across, along)
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    normals *= np.where(normals[..., 2:] < 0.0, -1.0, 1.0)
    corner = (np.arange(AROUND)[:, None] * (ACROSS + 1) + np.arange(ACROSS)).ravel()
    right, out_of = corner + ACROSS + 1, corner + 1
    faces = np.stack([corner, out_of, right + 1, corner, right + 1, right], axis=1).reshape(-1, 3).astype(np.int32)
    return Eyeshade(sealed(points.reshape(-1, 3)), sealed(normals.reshape(-1, 3)), faces)


def _forehead(skin: Floats, angles: Floats) -> Floats:
    """(n,) how far from the axis the forehead is in each direction."""
    forward, left, up = skin.T
    band = np.abs(up - HEIGHT) < BAND
    seen = np.arctan2(left[band], forward[band] - AXIS)
    away = np.hypot(left[band], forward[band] - AXIS)
    near = np.abs(seen - angles[:, None]) < np.radians(8.0)
    return np.asarray(np.where(near, away, 0.0).max(axis=1))
