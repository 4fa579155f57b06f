"""Places the site between a foreign robot's eyes on the front of its head, which no file names."""

from collections.abc import Mapping, Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot_schema import SiteTable
from kinesic.sim.importer.model_tree import ModelPart
from kinesic.sim.importer.segments import FIXED_HEAD, HEAD, HEAD_GIRTH, SegmentLayout, rounded_triple
from kinesic.sim.importer.zero_pose import HumanoidGeometry

HIGH = 0.5  # of a head's height above its lowest place
TALLEST = 0.6  # arm lengths from the top of a head to where a neck must have begun
BAND = 0.09  # arm lengths above and below the eyes in which a head's front is looked for
WIDE = 0.25  # arm lengths from the midline in which a head without neck is looked for
FEWEST_PLACES = 12  # places by which a head is known


def place_eyes(figure: HumanoidGeometry, where: SegmentLayout, carried: Mapping[str, Sequence[int]]) -> SiteTable:
    """Finds the middle of a head's front, looking ahead.

    Args:
        figure: the robot, arms hanging.
        where: its segments.
        carried: segment -> parts of the tree.
    """
    size, tree = figure.arm_length, figure.tree
    if figure.neck:
        whole, last = tree.lump(tree.below(figure.neck[0])), tree.lump(tree.below(figure.neck[-1]))
        at = _front(_places(last), size)
        if at is None:
            at = sealed(whole.centre + HEAD_GIRTH * size * np.array([1.0, 0.0, 0.2]))
        return SiteTable(HEAD, rounded_triple(where.inside(HEAD, at)), (1.0, 0.0, 0.0))
    shoulder = figure.arms["l"].centres.shoulder
    between = np.array([shoulder[0], 0.0, shoulder[2]])
    seen = _places(tree.lump(carried[where.carrier])) if carried.get(where.carrier) else np.zeros((0, 3))
    above = seen[:, 2] > between[2] + FIXED_HEAD[0] * size
    at = _front(sealed(seen[above & (np.abs(seen[:, 1]) < WIDE * size)]), size)
    if at is None:
        at = sealed(between + size * np.array([HEAD_GIRTH, 0.0, 0.35]))
    return SiteTable(where.carrier, rounded_triple(where.inside(where.carrier, at)), (1.0, 0.0, 0.0))


def _places(part: ModelPart) -> Floats:
    """(n, 3) [m] places on the surface of a part in the world: of its meshes, or else of its shapes."""
    if part.surfaces:
        return sealed(np.concatenate([surface.mesh.vertices for surface in part.surfaces]))
    ways = np.concatenate([np.eye(3), -np.eye(3)])
    ends = [(end, shape.radius) for shape in part.shapes for end in (shape.start, shape.end)]
    return sealed(np.concatenate([np.zeros((0, 3)), *(end + radius * ways for end, radius in ends)]))


def _front(places: Floats, size: float) -> Floats | None:
    """(3,) [m] the foremost place half-way up a head, on the midline; None where too little of one is known."""
    if len(places) < FEWEST_PLACES:
        return None
    top = float(places[:, 2].max())
    low = max(float(places[:, 2].min()), top - TALLEST * size)
    high = low + HIGH * (top - low)
    band = np.abs(places[:, 2] - high) < BAND * size
    return sealed([float(places[band, 0].max()), 0.0, high]) if band.any() else None
