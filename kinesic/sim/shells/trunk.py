"""Shell design of pelvis, trunk and head."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES
from kinesic.body.skeleton import Capsule
from kinesic.sim.shells.distance import (
    DistanceField,
    ball,
    blended_union,
    box,
    cone,
    drum,
    half_space,
    half_space_above,
    half_space_below,
    loft,
    rounded_intersection,
    sharp_union,
)
from kinesic.sim.shells.part import (
    BLEND_RADIUS,
    EDGE_ROUNDING,
    FRONT_RADIUS,
    SKIN_THICKNESS,
    TRIANGLE_BUDGET,
    VISOR_HALF_SIZE,
    Housing,
    ShellPart,
    enclose_in_box,
    enclose_in_drum,
)

MIDLINE_TOLERANCE = 0.004  # [m] distance from the midline below which a point counts as on it
MIN_SHAPE_SPACING = 0.005  # [m] smallest height difference between successive capsules of a loft
UP_AXIS = sealed([0.0, 0.0, 1.0])  # unit vector in the world and in trunk segments
TRUNK_CLEARANCE = 0.0045  # [m] distance of a trunk from servo corners; allows for coarse triangles of the trunk
HEAD_HALF_SIZE = sealed([1.10, 1.20, 1.16])  # half depth, width and height of the head's shell / those of its capsule
HEAD_ROUNDING = 1.02  # [head radii] rounding radius of the edges of the head's shell
CHIN_DROP = 0.008  # [m] lowering of the head's shell below the centre of the head's capsule, so that it hides the neck
EAR_SIZE = (0.36, 1.27)  # [head radii] radius of the ears, and distance of the ears' flat ends from the midline
EAR_CENTRE = (-0.15, 0.0)  # [head radii] position of the ears ahead of and above the head's centre
COLLAR_LEVELS = sealed(
    [[0.55, 0.62], [1.0, 0.22], [1.45, 0.0]]
)  # rows: height above the axis of the shoulder girdle's capsule / capsule radius, collar width / capsule width
COLLAR_RADII = sealed([0.92, 0.86, 0.78])  # depth of the collar at `COLLAR_LEVELS` / depth of the girdle
COLLAR_TOP = 1.88  # height of the collar's rim above the axis of the shoulder girdle / its radius
PEDESTAL_LEVELS = (0.0, 0.010, 0.030, 0.060, 0.110, 0.190)  # [m] heights of the pedestal's cross-sections
PEDESTAL_RADII = (2.80, 2.78, 2.50, 1.55, 1.05, 0.82)  # radius of the pedestal at `PEDESTAL_LEVELS` / column radius
PEDESTAL_RIM = 0.007  # [m] height of the pedestal's dark rim
COLUMN_TOP = (0.06, 0.92)  # upper edge of the column: [m] distance below its upper end, and radius / column radius


def head(part: ShellPart) -> Housing:
    """Design the housing of the head.

    It is a round block with a front bent around the vertical axis, a visor around the eyes and flat ears.
    """
    largest, size = max(part.capsules, key=lambda c: c.radius), part.robot.arm_length
    middle, half_height_of_head = (largest.start + largest.end) / 2, abs(float((largest.end - largest.start)[2])) / 2
    middle = middle - CHIN_DROP * UP_AXIS
    extent = largest.radius * np.ones(3) + half_height_of_head * UP_AXIS
    half = HEAD_HALF_SIZE * extent
    block = box(middle, half, min(HEAD_ROUNDING * largest.radius, float(half.min())))
    eyes = part.robot.sites.get("eyes")
    bend = max(FRONT_RADIUS * size, 1.2 * largest.radius)
    front = middle + (half[0] - bend) * np.array([1.0, 0.0, 0.0])
    solids = [rounded_intersection(block, drum(front, UP_AXIS, bend, 4 * largest.radius, 0.01), 0.008)]
    solids += [enclose_in_box(servo, 2 * EDGE_ROUNDING) for servo in part.servos]
    ear_at = middle + largest.radius * np.array([EAR_CENTRE[0], 0.0, EAR_CENTRE[1]])
    ear_radius, ear_reach = (factor * largest.radius for factor in EAR_SIZE)
    ears = drum(ear_at, np.array([0.0, 1.0, 0.0]), ear_radius, ear_reach, 0.006)
    dark = [drum(ear_at, np.array([0.0, 1.0, 0.0]), ear_radius + 0.002, 2 * ear_reach, 0.0)]
    seam = half_space(np.array([1.0, 0.0, 0.0]), float(middle[0] - 0.3 * largest.radius))
    if eyes is not None and eyes.segment == part.segment.name and eyes.facing[0] > 0.9:
        dark.append(_make_visor(eyes.position, VISOR_HALF_SIZE[0] * size, VISOR_HALF_SIZE[1] * size))
    solid = blended_union([blended_union(solids, 2.5 * BLEND_RADIUS), ears], 0.004)
    extreme_points = np.vstack(
        [part.extreme_points, middle + half, middle - half, ear_at + ear_reach, ear_at - ear_reach]
    )
    return Housing(solid, sharp_union(dark), (seam,), extreme_points, TRIANGLE_BUDGET["head"])


def _make_visor(eyes: Floats, half_width: float, half_height: float) -> DistanceField:
    """Return the distance field of a rounded rectangular prism at the eyes."""

    def field(points: Floats) -> Floats:
        across, up = (points[:, 1] - eyes[1]) / half_width, (points[:, 2] - eyes[2]) / half_height
        rim = ((across**4 + up**4) ** 0.25 - 1.0) * half_height
        return np.asarray(np.where(points[:, 0] > eyes[0] - 0.6 * half_width, rim, half_height))

    return field


def trunk(part: ShellPart, moving: set[str]) -> Housing:
    """Design the housing of a part of the trunk.

    It is a loft through lateral shapes, with bars, and drums and boxes around servos.
    """
    parts, standing = list(_list_rigid_parts(part, moving)), part.segment.parent is None
    capsules = [c for member in parts for c in member.capsules]
    lateral = _select_lateral(capsules)
    others = [c for c in capsules if c not in lateral]
    solids = [*_list_bars(others, standing=standing)]
    if lateral:
        solids.insert(0, _loft_capsules(lateral, standing=standing, necked=_has_neck(lateral, others)))
    for servo in (servo for member in parts for servo in member.servos):
        centred = np.linalg.norm(servo.centre[:2]) < MIDLINE_TOLERANCE
        solids.append(
            enclose_in_drum(servo, servo.centre, UP_AXIS)[0]
            if centred
            else enclose_in_box(servo, clearance=TRUNK_CLEARANCE)
        )
    dark = [*_list_joint_balls(parts), *_list_waists(lateral, others, standing=standing)]
    lines = [half_space(UP_AXIS, (float(a.start[2]) + float(b.start[2])) / 2) for a, b in pairwise(lateral)]
    extreme_points = np.concatenate([member.extreme_points for member in parts])
    for pedestal in filter(None, [_find_column(others)] if standing else []):
        foot = np.array([*pedestal.start[:2], _find_foot(pedestal)])
        plate = max(PEDESTAL_RADII) * pedestal.radius * np.array([[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]])
        extreme_points = np.concatenate([extreme_points, foot + plate])
        dark.append(half_space_below(float(foot[2]) + PEDESTAL_RIM))
    return Housing(
        blended_union(solids, 1.5 * BLEND_RADIUS),
        sharp_union(dark),
        tuple(lines),
        extreme_points,
        TRIANGLE_BUDGET["stand" if standing else "trunk"],
    )


def _select_lateral(capsules: Sequence[Capsule]) -> list[Capsule]:
    """Select the capsules that lie across the midline.

    They are sorted upwards, each clearly above the previous one.
    """
    selected: list[Capsule] = []
    for shape in sorted(capsules, key=lambda c: float(c.start[2])):
        axis_vector, middle = np.abs(shape.end - shape.start), (shape.start + shape.end) / 2
        across = (
            axis_vector[1] >= axis_vector[2]
            and axis_vector[0] < MIDLINE_TOLERANCE
            and np.abs(middle[:2]).max() < MIDLINE_TOLERANCE
        )
        if across and (not selected or shape.start[2] - selected[-1].start[2] > MIN_SHAPE_SPACING):
            selected.append(shape)
    return selected


def _has_neck(lateral: Sequence[Capsule], others: Sequence[Capsule]) -> bool:
    """Return whether a capsule, like a neck, ends above the shoulder capsule."""
    return bool(lateral) and any(c.end[2] > lateral[-1].start[2] + lateral[-1].radius for c in others)


def _loft_capsules(lateral: Sequence[Capsule], *, standing: bool, necked: bool) -> DistanceField:
    """Return the distance field of a loft through lateral capsules.

    A single capsule gets some height. The loft of a moving part is extended down to the segment below, and up to a
    collar around a neck.
    """
    heights = np.array([float(c.start[2]) for c in lateral])
    widths = np.array([abs(float((c.end - c.start)[1])) / 2 for c in lateral])
    radii = np.array([c.radius + SKIN_THICKNESS for c in lateral])
    if len(lateral) == 1:
        return loft(heights[0] + np.array([-0.3, 0.22]) * radii[0], np.tile(widths, 2), np.tile(radii, 2))
    if not standing:
        heights = np.insert(heights, 0, heights[0] - 0.3 * radii[0])
        widths, radii = np.insert(widths, 0, widths[0]), np.insert(radii, 0, radii[0])
    if necked:
        rises, narrows = COLLAR_LEVELS.T
        heights = np.append(heights, heights[-1] + rises * lateral[-1].radius)
        widths, radii = np.append(widths, narrows * widths[-1]), np.append(radii, COLLAR_RADII * radii[-1])
    return loft(heights, widths, radii)


def _list_bars(shapes: Sequence[Capsule], *, standing: bool) -> Iterator[DistanceField]:
    """Yield distance fields of bars along capsules and of a column's pedestal."""
    column = _find_column(shapes) if standing else None
    for shape in shapes:
        if shape is column:
            yield _make_pedestal(shape)
        else:
            yield cone(shape.start, shape.end, 0.95 * shape.radius, 0.95 * shape.radius)


def _find_column(shapes: Sequence[Capsule]) -> Capsule | None:
    """Return the first capsule taller than four radii, or None."""
    return next((c for c in shapes if np.ptp([c.start[2], c.end[2]]) > 4 * c.radius), None)


def _find_foot(column: Capsule) -> float:
    """Return the height [m] of a column's lower end."""
    return float(min(column.start[2], column.end[2])) - column.radius


def _make_pedestal(column: Capsule) -> DistanceField:
    """Return the distance field of a column with a wide, round base."""
    foot, top = _find_foot(column), float(max(column.start[2], column.end[2]))
    levels = [foot + level for level in PEDESTAL_LEVELS]
    heights = np.array([*levels, max(top - COLUMN_TOP[0], levels[-1] + COLUMN_TOP[0]), top + COLUMN_TOP[0]])
    radii = column.radius * np.array([*PEDESTAL_RADII, COLUMN_TOP[1], COLUMN_TOP[1]])
    body = loft(heights, np.zeros(len(heights)), radii)

    def moved(points: Floats) -> Floats:
        return body(points - np.array([*column.start[:2], 0.0]))

    return rounded_intersection(moved, half_space_above(foot), 0.006)


def _list_waists(lateral: Sequence[Capsule], others: Sequence[Capsule], *, standing: bool) -> Iterator[DistanceField]:
    """Yield the distance fields of a trunk part's dark joint regions.

    These are the neck, the lower end of a moving part and the upper end of a standing part.
    """
    if not lateral:
        return
    lowest, half_height = lateral[0], lateral[-1]
    if _has_neck(lateral, others):
        yield half_space_above(float(half_height.start[2]) + COLLAR_TOP * half_height.radius)
    yield (
        half_space_above(float(half_height.start[2]) + 0.85 * half_height.radius)
        if standing
        else half_space_below(float(lowest.start[2]) - 0.55 * lowest.radius)
    )


def _list_rigid_parts(part: ShellPart, moving: set[str]) -> Iterator[ShellPart]:
    """Yield a part and all parts fixed to it."""
    yield part
    for child in part.children:
        if child.name not in moving:
            yield from _list_rigid_parts(
                ShellPart(part.robot, child, sealed(part.origin + child.origin_in_parent)), moving
            )


def _list_joint_balls(parts: Sequence[ShellPart]) -> Iterator[DistanceField]:
    """Yield the distance fields of balls where the arms begin."""
    for part in parts:
        arms = {name for side in SIDES for name in part.robot.arm(side).segments}
        for child in part.children:
            if child.name in arms and child.capsules:
                first = child.capsules[0]
                yield ball(part.origin + child.origin_in_parent + 0.5 * first.start, 0.9 * first.radius)
