"""Placement of the eye site on the front of a robot's head.

MJCF and URDF files contain no such site.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot_schema import SiteTable
from kinesic.sim.importer.hinge_row import list_surface_points
from kinesic.sim.importer.segments import FIXED_HEAD, HEAD_RADIUS_RATIO, HEAD_SEGMENT, SegmentLayout, round_triple
from kinesic.sim.importer.zero_pose import HumanoidGeometry, find_mid_shoulders

EYE_HEIGHT_FRACTION = 0.5  # height of the eyes / height of the head, from its lowest point
MAX_HEAD_HEIGHT = 0.6  # [arm lengths] largest assumed height of a head, measured from its top
FRONT_BAND = 0.09  # [arm lengths] search range for the head's front above and below the eyes
MAX_HEAD_HALF_WIDTH = 0.25  # [arm lengths] search range for a fixed head on both sides of the midline
MIN_HEAD_POINTS = 12  # surface points needed to recognise a head


def place_eyes(figure: HumanoidGeometry, layout: SegmentLayout, carried: Mapping[str, Sequence[int]]) -> SiteTable:
    """Return a forward-facing eye site in the middle of the head's front.

    Args:
        figure: Robot with hanging arms.
        layout: Segments of the robot.
        carried: Segment -> indices of its parts in the tree.
    """
    size, tree = figure.arm_length, figure.tree
    if figure.neck:
        neck_part, last = tree.merge_parts(tree.below(figure.neck[0])), tree.merge_parts(tree.below(figure.neck[-1]))
        position = _find_front(list_surface_points(last), size)
        if position is None:
            position = sealed(neck_part.centre + HEAD_RADIUS_RATIO * size * np.array([1.0, 0.0, 0.2]))
        return SiteTable(HEAD_SEGMENT, round_triple(layout.inside(HEAD_SEGMENT, position)), (1.0, 0.0, 0.0))
    mid_shoulders = find_mid_shoulders(figure)
    points = (
        list_surface_points(tree.merge_parts(carried[layout.carrier]))
        if carried.get(layout.carrier)
        else np.zeros((0, 3))
    )
    is_above = points[:, 2] > mid_shoulders[2] + FIXED_HEAD[0] * size
    position = _find_front(sealed(points[is_above & (np.abs(points[:, 1]) < MAX_HEAD_HALF_WIDTH * size)]), size)
    if position is None:
        position = sealed(mid_shoulders + size * np.array([HEAD_RADIUS_RATIO, 0.0, 0.35]))
    return SiteTable(layout.carrier, round_triple(layout.inside(layout.carrier, position)), (1.0, 0.0, 0.0))


def _find_front(points: Floats, size: float) -> Floats | None:
    """Return the eyes' midpoint (3,) [m] from a head's surface points.

    It is at half the head's height, as far forward as the head there. None if there are too few points.
    """
    if len(points) < MIN_HEAD_POINTS:
        return None
    top = float(points[:, 2].max())
    bottom = max(float(points[:, 2].min()), top - MAX_HEAD_HEIGHT * size)
    eye_height = bottom + EYE_HEIGHT_FRACTION * (top - bottom)
    band = np.abs(points[:, 2] - eye_height) < FRONT_BAND * size
    return sealed([float(points[band, 0].max()), 0.0, eye_height]) if band.any() else None
