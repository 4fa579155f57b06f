"""Where on a row of teeth each vertex of one lies, so that single teeth can be drawn on it.

The head has two strips, one for each jaw: a front that runs from the gums to the cutting edge, and behind it the side
of the tongue.
"""

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.mesh import Mesh

MILLIMETRES = 1000.0
ROW_DEPTH = 0.043  # [m] how far behind its front the middle is that a row of teeth runs round
SECTOR = np.radians(24.0)  # round it, within which the cutting edge is looked for
EDGE = 0.0007  # [m] that is as far from the gums as the furthest
BEHIND = 0.003  # [m] that what faces the tongue is nearer to the middle than the cutting edge is


def teeth_chart(mesh: Mesh) -> Floats:
    """(t, 4) of each vertex of the teeth, where on its row it lies.

    To the left along the cutting edge from the middle [mm]; from there towards the gums [mm], below 0 on the side of
    the tongue; how far forward, in distances between the eyes; 1 in the upper row, -1 in the lower.
    """
    teeth = mesh.vertices("teeth")
    points = mesh.positions[teeth]
    upper = _upper(mesh)
    found = np.zeros((len(teeth), 4))
    for jaw in (1.0, -1.0):
        row = upper == (jaw > 0.0)
        found[row, :2] = _along(points[row], jaw)
        found[row, 3] = jaw
    found[:, 2] = points[:, 0] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    return sealed(found)


def _upper(mesh: Mesh) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """(t,) whether each vertex of the teeth is in the upper row: rows share no faces."""
    teeth = mesh.vertices("teeth")
    place = np.full(len(mesh.positions), -1)
    place[teeth] = np.arange(len(teeth))
    corners = place[mesh.faces]
    corners = corners[(corners >= 0).all(axis=1)]
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    graph = scipy.sparse.coo_array((np.ones(len(ends)), tuple(ends.T)), shape=(len(teeth), len(teeth)))
    _, row = scipy.sparse.csgraph.connected_components(graph, directed=False)
    heights = mesh.positions[teeth, 2]
    return np.asarray(row == np.argmax([heights[row == k].mean() for k in range(row.max() + 1)]))


def _along(points: Floats, jaw: float) -> Floats:
    """(n, 2) along a row and away from its cutting edge [mm]."""
    forward = points[:, 0] - points[:, 0].max() + ROW_DEPTH
    angles = np.arctan2(points[:, 1], forward)
    slope, _ = np.polyfit(points[:, 0], points[:, 2], 1)  # back teeth stand higher
    level = -jaw * (points[:, 2] - slope * points[:, 0])
    near = np.abs(angles[:, None] - angles) < SECTOR / 2
    edge = np.flatnonzero(level > np.where(near, level, -np.inf).max(axis=1) - EDGE)
    order = edge[np.argsort(angles[edge])]
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points[order], axis=0), axis=1))])
    along = np.interp(angles, angles[order], lengths) - np.interp(0.0, angles[order], lengths)
    away = jaw * (points[:, 2] - np.interp(angles, angles[order], points[order, 2]))
    reach = np.hypot(forward, points[:, 1])
    inner = reach < np.interp(angles, angles[order], reach[order]) - BEHIND
    return MILLIMETRES * np.stack([along, np.where(inner, -np.maximum(away, 0.001), np.maximum(away, 0.0))], axis=1)
