"""Blend shapes and eye rotations of the human face over time."""

from base64 import b64encode
from collections.abc import Mapping, Sequence

import numpy as np

from kinesic.body.rotation import rotation_to_vector
from kinesic.face.assets.action_units import compute_gaze_rotation, compute_shape_weights, read_intensities
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.mesh import Mesh
from kinesic.report.report import Json
from kinesic.report.scene import pack_rows

WEIGHT_STEP = 1 / 255  # blend-shape weight per count of a byte
GAZE_STEP = 1e-4  # [rad] eye rotation per count of a 16-bit integer
MIN_USED_WEIGHT = WEIGHT_STEP / 2  # shapes with smaller weights are omitted


def face_data(units: Sequence[Mapping[str, float]]) -> dict[str, Json]:
    """Pack blend-shape weights and eye rotations of a face over time.

    Weights are bytes, one row of shapes per frame. Rotations of the left and right eye are rotation vectors of 16-bit
    integers, six per frame. A shape moves some vertices, by bytes times its own step.

    Args:
        units: intensities 0..1 of each action unit, one per frame.
    """
    mesh = load_figure().mesh
    weights = np.array([compute_shape_weights(mesh, row) for row in units])
    used = np.flatnonzero(weights.max(axis=0) > MIN_USED_WEIGHT)
    intensities = [read_intensities(row) for row in units]
    eye_rotations = np.array([[compute_gaze_rotation(row, eye) for eye in (0, 1)] for row in intensities])
    gaze = rotation_to_vector(eye_rotations).reshape(-1, 6)
    return {
        "shapes": [_shape(mesh, int(place)) for place in used],
        "weights": pack_rows(weights[:, used] / WEIGHT_STEP, "u1"),
        "weight_step": WEIGHT_STEP,
        "gaze": pack_rows(gaze / GAZE_STEP, "<i2"),
        "gaze_step": GAZE_STEP,
    }


def _shape(mesh: Mesh, place: int) -> dict[str, Json]:
    """Pack the vertex displacements of one blend shape."""
    moves = mesh.deltas[:, [place]].toarray().reshape(-1, 3)
    step = float(np.abs(moves).max()) / np.iinfo(np.int8).max or 1.0
    whole = np.rint(moves / step)
    vertices = np.flatnonzero(whole.any(axis=1))
    return {
        "step": step,
        "vertices": b64encode(vertices.astype("<u2").tobytes()).decode(),
        "moves": pack_rows(whole[vertices], "i1"),
    }
