"""Chart of the head: unrolled surface coordinates of each vertex at rest.

The chart unrolls a cylinder around the front of the head: a = 2 atan2(left, forward + 1.6) and y = up, in distances
between the eyes, from the midpoint between them. Wrinkles and painting use it; they follow the shapes, since the rest
position belongs to the vertex. A mask excludes the back of the head, where the chart has its seam.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.mesh import MESH_PARTS, Indices, Mesh
from kinesic.face.assets.teeth import compute_teeth_chart

CHART_WIDTH = 4 * np.pi  # range of the chart coordinate a, twice the angle around the head [rad]
AXIS_OFFSET = 1.6  # distance of the cylinder axis behind the eyes, in distances between the eyes
WINDOW_LEFT_RIGHT = (-1.8, 1.8)  # [rad] painted range of chart coordinate a (twice the angle around the head)
WINDOW_LOW_HIGH = (-2.2, 1.6)  # [eye distances] range of the chart coordinate y (height) that is painted
MASK_RAMP = (-0.6, -0.4)  # [eye distances] forward positions between which the mask of painted skin rises from 0 to 1
HAIRLINE_POINTS = (  # hairline: angle from the front [deg], height in distances between the eyes
    (0.0, 1.25),
    (25.0, 1.23),
    (42.0, 1.05),
    (54.0, 0.82),
    (61.0, 0.55),
    (66.0, 0.0),
    (70.0, -0.3),
    (80.0, -0.3),
    (85.0, 0.1),
    (92.0, 0.28),
    (106.0, 0.30),
    (118.0, -0.45),
    (140.0, -0.8),
    (180.0, -1.0),
)
MOUTH_REGION = (0.6, -1.45, -0.8)  # [eye distances] search region of the mouth: half width, lowest and highest point
THROAT_DEPTH = -1.0  # [eye distances] rearmost forward position in the mouth; the neck lies farther back
MOUTH_DEPTH_UNIT = 0.1  # unit of depth in the mouth, in distances between the eyes
LIP_DEPTH = 0.35  # [MOUTH_DEPTH_UNIT] depth behind the lips up to which the skin counts as lip
MAX_MOUTH_DEPTH = 6.0  # [MOUTH_DEPTH_UNIT] depth behind the lips beyond which the mouth gets no darker
CROWN_CENTRE = -1.15  # [eye distances] forward position of the vertical axis of the angles in HAIRLINE_POINTS


def compute_chart_window() -> tuple[float, float, float, float]:
    """Return scale and offset from head surface to texture coordinates 0..1.

    Returns:
        (a scale, y scale, a offset, y offset).
    """
    (left, right), (low, high) = WINDOW_LEFT_RIGHT, WINDOW_LOW_HIGH
    return 1 / (right - left), 1 / (high - low), -left / (right - left), -low / (high - low)


@lru_cache(maxsize=4)
def compute_vertex_chart(mesh: Mesh) -> Floats:
    """Return surface coordinates and shading attributes of each vertex, (v, 4).

    They are a, y, front mask minus 6 x depth in the mouth, and height over the hairline. For the eyes: direction at
    rest from the centre of the eyeball as left, up, forward; then 0. For the tongue the third is the forward position.
    For teeth: `compute_teeth_chart`. For cloth: square root of the linear colour, and gloss.
    """
    rest = mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = rest.T
    mask = np.clip((forward - MASK_RAMP[0]) / (MASK_RAMP[1] - MASK_RAMP[0]), 0.0, 1.0)
    mask = mask * mask * (3 - 2 * mask) - 6 * np.maximum(measure_mouth_depth(mesh, MAX_MOUTH_DEPTH) - LIP_DEPTH, 0.0)
    chart = np.stack([2 * np.arctan2(left, forward + AXIS_OFFSET), up, mask, measure_hairline_height(rest)], axis=1)
    eyes = mesh.vertices("eyes")
    spokes = mesh.positions[eyes] - mesh.eyes[np.where(mesh.positions[eyes, 1] > 0.0, 0, 1)]
    spokes /= np.linalg.norm(spokes, axis=1, keepdims=True)
    tongue = mesh.vertices("tongue")
    chart[tongue, 2] = forward[tongue]
    chart[mesh.vertices("teeth")] = compute_teeth_chart(mesh)
    chart[eyes] = np.column_stack([spokes[:, [1, 2, 0]], np.zeros(len(eyes))])
    if mesh.plain is not None:
        cloth = mesh.vertices("cloth")
        chart[cloth] = mesh.plain[cloth]
    return sealed(chart)


def unroll_mesh(place: Floats, triangles: Indices, skin: NDArray[np.bool_]) -> tuple[NDArray[np.intp], Floats, Indices]:
    """Split the skin mesh behind the head, where surface coordinates jump.

    Other parts stay whole: their chart attributes have other units, such as millimetres along a row of teeth.

    Args:
        place: (v, 4) result of `compute_vertex_chart`.
        triangles: (t, 3) corners.
        skin: (t,) triangles of the skin.

    Returns:
        (w,) source vertex of each new vertex, the original ones first; (w, 4) chart attributes; (t, 3) corners, none of
        them across the seam.
    """
    corners = place[triangles, 0]
    torn = skin & (np.ptp(corners, axis=1) > CHART_WIDTH / 2)
    low = torn[:, None] & (corners < 0.0)
    twice, which = np.unique(triangles[low], return_inverse=True)
    new_triangles = triangles.copy()
    new_triangles[low] = len(place) + which
    copied_places = place[twice] + np.array([CHART_WIDTH, 0.0, 0.0, 0.0])
    return np.concatenate([np.arange(len(place)), twice]), np.concatenate([place, copied_places]), new_triangles


def measure_mouth_depth(mesh: Mesh, deepest: float = 1.0) -> Floats:
    """Return the (v,) depth of skin vertices behind the lips.

    It is in `MOUTH_DEPTH_UNIT`, at most `deepest`, and 0 outside.
    """
    rest = mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = rest.T
    near = (
        (forward > THROAT_DEPTH)
        & (np.abs(left) < MOUTH_REGION[0])
        & (up > MOUTH_REGION[1])
        & (up < MOUTH_REGION[2])
        & (mesh.parts == MESH_PARTS.index("skin"))
    )
    around = scipy.spatial.cKDTree(rest[near, 1:]).query_ball_point(rest[near, 1:], MOUTH_DEPTH_UNIT)
    foremost = np.array([forward[near][neighbours].max() for neighbours in around])
    depth = np.zeros(len(rest))
    depth[near] = np.clip((foremost - forward[near] - MOUTH_DEPTH_UNIT) / MOUTH_DEPTH_UNIT, 0.0, deepest)
    return depth


def measure_hairline_height(rest: Floats) -> Floats:
    """Return the (n,) height of (n, 3) rest positions over the hairline.

    Lengths are distances between the eyes.
    """
    forward, left, up = rest.T
    angles, heights = np.array(HAIRLINE_POINTS).T
    round_from_front = np.degrees(np.arctan2(np.abs(left), forward - CROWN_CENTRE))
    return np.asarray(up - np.interp(round_from_front, angles, heights))
