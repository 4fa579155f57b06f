"""The chart: where on the head at rest a vertex is, as two coordinates that need no texture map of the mesh.

A cylinder round the front of the head unrolled: a = 2 atan2(left, forward + 1.6) and y = up, in units of the distance
between the eyes, from the middle between them. Wrinkles and painting are drawn in it; they ride with the shapes, since
the rest position belongs to the vertex. The mask keeps them off the back of the head, where the chart has its seam.
"""

from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.mesh import PARTS, Indices, Mesh
from kinesic.face.assets.teeth import teeth_chart

CHART_WIDTH = 4 * np.pi  # width of the whole chart
AXIS = 1.6  # how far behind the eyes the cylinder has its axis
LEFT_RIGHT = (-1.8, 1.8)  # of the window that is drawn
LOW_HIGH = (-2.2, 1.6)
FRONT = (-0.6, -0.4)  # how far forward the mask goes from 0 to 1
HAIRLINE = (  # [deg] round from the front, height
    (0.0, 1.32),
    (25.0, 1.30),
    (45.0, 1.02),
    (58.0, 0.72),
    (70.0, 0.35),
    (80.0, 0.12),
    (92.0, 0.28),
    (108.0, 0.36),
    (122.0, -0.2),
    (140.0, -0.75),
    (180.0, -1.0),
)
MOUTH = (0.6, -1.45, -0.8)  # where its inside is looked for: to the side, from below, to above
THROAT = -1.0  # and how far back; the neck is behind
BEFORE = 0.1  # how far the face is in front of it
LIP = 0.35  # times that, and less: what is no deeper is the red of the lips
DEEP = 6.0  # times that: what is deeper in the mouth is as dark
CROWN = -1.15  # how far forward the middle is that the hairline goes round


def chart_window() -> tuple[float, float, float, float]:
    """Scale and offset from the chart to texture coordinates 0..1: (a scale, y scale, a offset, y offset)."""
    (left, right), (low, high) = LEFT_RIGHT, LOW_HIGH
    return 1 / (right - left), 1 / (high - low), -left / (right - left), -low / (high - low)


@lru_cache(maxsize=4)
def vertex_chart(mesh: Mesh) -> Floats:
    """(v, 4) of each vertex: chart's a and y, front mask minus 6 x depth in the mouth, height over the hairline.

    For the eyes: direction at rest from the centre of the eyeball as left, up, forward; then 0. For the tongue the
    third is how far forward it is. For teeth: `teeth_chart`. For cloth: its colour, and how much it shines.
    """
    rest = mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = rest.T
    mask = np.clip((forward - FRONT[0]) / (FRONT[1] - FRONT[0]), 0.0, 1.0)
    mask = mask * mask * (3 - 2 * mask) - 6 * np.maximum(mouth(mesh, DEEP) - LIP, 0.0)
    found = np.stack([2 * np.arctan2(left, forward + AXIS), up, mask, hair(rest)], axis=1)
    eyes = mesh.vertices("eyes")
    spokes = mesh.positions[eyes] - mesh.eyes[np.where(mesh.positions[eyes, 1] > 0.0, 0, 1)]
    spokes /= np.linalg.norm(spokes, axis=1, keepdims=True)
    tongue = mesh.vertices("tongue")
    found[tongue, 2] = forward[tongue]
    found[mesh.vertices("teeth")] = teeth_chart(mesh)
    found[eyes] = np.column_stack([spokes[:, [1, 2, 0]], np.zeros(len(eyes))])
    if mesh.plain is not None:
        cloth = mesh.vertices("cloth")
        found[cloth] = mesh.plain[cloth]
    return sealed(found)


def unroll(place: Floats, triangles: Indices) -> tuple[NDArray[np.intp], Floats, Indices]:
    """Cuts a mesh open behind the head, where the right end of the chart meets its left one.

    Args:
        place: (v, 4) of `vertex_chart`.
        triangles: (t, 3) corners.

    Returns:
        (w,) which vertex each is, the mesh's own first; (w, 4) places; (t, 3) corners, none of them across the seam.
    """
    corners = place[triangles, 0]
    torn = np.ptp(corners, axis=1) > CHART_WIDTH / 2
    low = torn[:, None] & (corners < 0.0)
    twice, which = np.unique(triangles[low], return_inverse=True)
    found = triangles.copy()
    found[low] = len(place) + which
    again = place[twice] + np.array([CHART_WIDTH, 0.0, 0.0, 0.0])
    return np.concatenate([np.arange(len(place)), twice]), np.concatenate([place, again]), found


def mouth(mesh: Mesh, deepest: float = 1.0) -> Floats:
    """(v,) how far inside the mouth a vertex of the skin is, in `BEFORE`, at most the deepest; 0 outside."""
    rest = mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = rest.T
    near = (
        (forward > THROAT)
        & (np.abs(left) < MOUTH[0])
        & (up > MOUTH[1])
        & (up < MOUTH[2])
        & (mesh.parts == PARTS.index("skin"))
    )
    around = scipy.spatial.cKDTree(rest[near, 1:]).query_ball_point(rest[near, 1:], BEFORE)
    foremost = np.array([forward[near][each].max() for each in around])
    found = np.zeros(len(rest))
    found[near] = np.clip((foremost - forward[near] - BEFORE) / BEFORE, 0.0, deepest)
    return found


def hair(rest: Floats) -> Floats:
    """(v,) how far each of (v, 3) rest positions lies over the hairline, in the chart's unit."""
    forward, left, up = rest.T
    angles, heights = np.array(HAIRLINE).T
    round_from_front = np.degrees(np.arctan2(np.abs(left), forward - CROWN))
    return np.asarray(up - np.interp(round_from_front, angles, heights))
