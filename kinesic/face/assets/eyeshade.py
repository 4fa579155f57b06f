"""Translucent eyeshade on the forehead against light from above."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.mesh import Mesh

BRIM_AXIS = -1.2  # [eye distances] forward position of the axis of the eyeshade's brim
BRIM_HEIGHT = 1.02  # [eye distances] height of the brim's inner edge over the eyes
FOREHEAD_BAND = 0.25  # [eye distances] half height of the band in which the forehead is measured
SKIN_GAP = 0.03  # [eye distances] distance of the eyeshade's brim from the skin
BRIM_LENGTH = 0.95  # [eye distances] length of the eyeshade's brim in the middle
BRIM_DROOP = 0.30  # descent of the eyeshade's brim per length
BRIM_HALF_ANGLE_DEG = 68.0  # [deg] extent of the brim to either side
FACES_AROUND = 48  # mesh faces of the eyeshade along the forehead
FACES_ACROSS = 6  # mesh faces of the eyeshade from inner to outer edge


@dataclass(frozen=True, eq=False)
class Eyeshade:
    """Double-sided triangle mesh of an eyeshade in the head's frame."""

    positions: Floats  # (v, 3) [m]
    normals: Floats  # (v, 3) unit, upward
    triangles: NDArray[np.int32]  # (t, 3)


def make_eyeshade(mesh: Mesh) -> Eyeshade:
    """Return the eyeshade that fits a head at rest."""
    unit = mesh.eyes[0, 1] - mesh.eyes[1, 1]
    angles = np.radians(np.linspace(-BRIM_HALF_ANGLE_DEG, BRIM_HALF_ANGLE_DEG, FACES_AROUND + 1))[:, None]
    inner = _measure_forehead(mesh.positions[mesh.vertices("skin")] / unit, angles[:, 0])[:, None] + SKIN_GAP
    out = (
        BRIM_LENGTH
        * np.sqrt(np.clip(np.cos(angles * 90.0 / BRIM_HALF_ANGLE_DEG), 0.02, 1.0))
        * np.linspace(0.0, 1.0, FACES_ACROSS + 1)
    )
    radius = inner + out
    points = (
        np.stack(
            [BRIM_AXIS + radius * np.cos(angles), radius * np.sin(angles), BRIM_HEIGHT - BRIM_DROOP * out], axis=-1
        )
        * unit
    )
    along, across = np.gradient(points, axis=0), np.gradient(points, axis=1)
    normals = np.cross(across, along)
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    normals *= np.where(normals[..., 2:] < 0.0, -1.0, 1.0)
    corner = (np.arange(FACES_AROUND)[:, None] * (FACES_ACROSS + 1) + np.arange(FACES_ACROSS)).ravel()
    right, out_of = corner + FACES_ACROSS + 1, corner + 1
    faces = np.stack([corner, out_of, right + 1, corner, right + 1, right], axis=1).reshape(-1, 3).astype(np.int32)
    return Eyeshade(sealed(points.reshape(-1, 3)), sealed(normals.reshape(-1, 3)), faces)


def _measure_forehead(skin: Floats, angles: Floats) -> Floats:
    """Return the (n,) distance of the forehead in each direction.

    Distances are from the axis of the brim, in distances between the eyes.
    """
    forward, left, up = skin.T
    band = np.abs(up - BRIM_HEIGHT) < FOREHEAD_BAND
    seen = np.arctan2(left[band], forward[band] - BRIM_AXIS)
    away = np.hypot(left[band], forward[band] - BRIM_AXIS)
    near = np.abs(seen - angles[:, None]) < np.radians(8.0)
    return np.asarray(np.where(near, away, 0.0).max(axis=1))
