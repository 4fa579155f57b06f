"""The face of a figure over time, as the scripts of pages draw it: the shapes that it uses, and how its eyes turn."""

from base64 import b64encode
from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.face.assets.action_units import gaze_rotation, intensities, shape_weights
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.mesh import Mesh
from kinesic.report.report import Json
from kinesic.report.scene import pack_rows

WEIGHT_STEP = 1 / 255
GAZE_STEP = 1e-4  # [rad]
LEAST_WEIGHT = WEIGHT_STEP / 2  # weight of a shape that is used


def face_data(units: Sequence[Mapping[str, float]]) -> dict[str, Json]:
    """Packs a face over time.

    Weights are bytes, one row of shapes for each frame; turns of the left and the right eye are rotation vectors of
    16-bit integers, six numbers a frame. A shape moves some vertices, by bytes times its own step.

    Args:
        units: action unit -> 0..1, of each frame.
    """
    mesh = load_figure().mesh
    weights = np.array([shape_weights(mesh, row) for row in units])
    used = np.flatnonzero(weights.max(axis=0) > LEAST_WEIGHT)
    told = [intensities(row) for row in units]
    gaze = np.concatenate([_turns([gaze_rotation(row, eye) for row in told]) for eye in (0, 1)], axis=1)
    return {
        "shapes": [_shape(mesh, int(place)) for place in used],
        "weights": pack_rows(weights[:, used] / WEIGHT_STEP, "u1"),
        "weight_step": WEIGHT_STEP,
        "gaze": pack_rows(gaze / GAZE_STEP, "<i2"),
        "gaze_step": GAZE_STEP,
    }


def _turns(rotations: Sequence[Floats]) -> Floats:
    """(m, 3) rotation vectors [rad]."""
    found: Floats = scipy.spatial.transform.Rotation.from_matrix(np.array(rotations)).as_rotvec()
    return found


def _shape(mesh: Mesh, place: int) -> dict[str, Json]:
    """Which vertices a shape moves, and how far."""
    moves = mesh.deltas[:, [place]].toarray().reshape(-1, 3)
    step = float(np.abs(moves).max()) / np.iinfo(np.int8).max or 1.0
    whole = np.rint(moves / step)
    vertices = np.flatnonzero(whole.any(axis=1))
    return {
        "step": step,
        "vertices": b64encode(vertices.astype("<u2").tobytes()).decode(),
        "moves": pack_rows(whole[vertices], "i1"),
    }
