"""Positions of vertices along the rows of teeth, for drawing single teeth.

The head has two strips, one for each jaw: a front that runs from the gums to the cutting edge, and behind it the side
of the tongue.
"""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.mesh import Mesh

MILLIMETRES_PER_METRE = 1000.0  # [mm/m]
TOOTH_ROW_DEPTH = 0.043  # [m] distance of the centre of a row of teeth behind its front
EDGE_SECTOR = np.radians(24.0)  # [rad] sector around the centre of a row of teeth in which the cutting edge is searched
EDGE_TOLERANCE = 0.0007  # [m] tolerance of the distance from the gums at the cutting edge
TONGUE_SIDE_DEPTH = 0.003  # [m] points of a tooth farther than this behind its cutting edge are on its tongue side


def compute_teeth_chart(mesh: Mesh) -> Floats:
    """Return (t, 4) dental coordinates of the vertices: along, across, forward, jaw.

    To the left along the cutting edge from the middle [mm]; from there towards the gums [mm], below 0 on the side of
    the tongue; the forward position, in distances between the eyes; 1 in the upper row, -1 in the lower.
    """
    teeth = mesh.vertices("teeth")
    points = mesh.positions[teeth]
    upper = _find_upper_row(mesh)
    chart = np.zeros((len(teeth), 4))
    for jaw in (1.0, -1.0):
        row = upper == (jaw > 0.0)
        chart[row, :2] = _unroll_row(points[row], jaw)
        chart[row, 3] = jaw
    chart[:, 2] = points[:, 0] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    return sealed(chart)


def _find_upper_row(mesh: Mesh) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """Return (t,) flags of the vertices in the upper row of teeth.

    The rows have no faces in common.
    """
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


def _unroll_row(points: Floats, jaw: float) -> Floats:
    """Return (n, 2) positions [mm] along and across a row of teeth.

    The second one is the distance from the cutting edge.
    """
    forward = points[:, 0] - points[:, 0].max() + TOOTH_ROW_DEPTH
    angles = np.arctan2(points[:, 1], forward)
    slope, _ = np.polyfit(points[:, 0], points[:, 2], 1)  # back teeth stand higher
    level = -jaw * (points[:, 2] - slope * points[:, 0])
    near = np.abs(angles[:, None] - angles) < EDGE_SECTOR / 2
    edge = np.flatnonzero(level > np.where(near, level, -np.inf).max(axis=1) - EDGE_TOLERANCE)
    order = edge[np.argsort(angles[edge])]
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points[order], axis=0), axis=1))])
    along = np.interp(angles, angles[order], lengths) - np.interp(0.0, angles[order], lengths)
    away = jaw * (points[:, 2] - np.interp(angles, angles[order], points[order, 2]))
    reach = np.hypot(forward, points[:, 1])
    inner = reach < np.interp(angles, angles[order], reach[order]) - TONGUE_SIDE_DEPTH
    return MILLIMETRES_PER_METRE * np.stack(
        [along, np.where(inner, -np.maximum(away, 0.001), np.maximum(away, 0.0))], axis=1
    )
