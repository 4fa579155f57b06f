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
    FOOT_PLATE,
    FRONT_RADIUS,
    SKIN_THICKNESS,
    TRIANGLE_BUDGET,
    VISOR_HALF_SIZE,
    Housing,
    ShellPart,
    enclose_in_box,
    enclose_in_drum,
)

MIDLINE_TOLERANCE = 0.004  # [m] largest distance of a point on the midline
MIN_SHAPE_SPACING = 0.005  # [m] smallest height difference of two lateral shapes
UP_AXIS = sealed([0.0, 0.0, 1.0])  # unit vector in the world and in trunk segments


def head(part: ShellPart) -> Housing:
    """Design the housing of the head.

    It is a rounded block with a front bent around the vertical axis, and a visor around the eyes.
    """
    largest, size = max(part.capsules, key=lambda c: c.radius), part.robot.arm_length
    middle, half_height_of_head = (largest.start + largest.end) / 2, abs(float((largest.end - largest.start)[2])) / 2
    half = np.array([0.975 * largest.radius, 1.08 * largest.radius, half_height_of_head + 0.99 * largest.radius])
    block = box(middle, half, 0.72 * largest.radius)
    eyes = part.robot.sites.get("eyes")
    bend = max(FRONT_RADIUS * size, 1.2 * largest.radius)
    front = middle + (half[0] - bend) * np.array([1.0, 0.0, 0.0])
    solids = [rounded_intersection(block, drum(front, UP_AXIS, bend, 4 * largest.radius, 0.01), 0.008)]
    solids += [enclose_in_box(servo, 2 * EDGE_ROUNDING) for servo in part.servos]
    seam = half_space(np.array([1.0, 0.0, 0.0]), float(middle[0] - 0.3 * largest.radius))
    dark = None
    if eyes is not None and eyes.segment == part.segment.name and eyes.facing[0] > 0.9:
        dark = _make_visor(eyes.position, VISOR_HALF_SIZE[0] * size, VISOR_HALF_SIZE[1] * size)
    return Housing(
        blended_union(solids, 2.5 * BLEND_RADIUS), dark, (seam,), part.extreme_points, TRIANGLE_BUDGET["head"]
    )


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
        solids.insert(0, _loft_capsules(lateral, standing=standing))
    for servo in (servo for member in parts for servo in member.servos):
        centred = np.linalg.norm(servo.centre[:2]) < MIDLINE_TOLERANCE
        solids.append(enclose_in_drum(servo, servo.centre, UP_AXIS)[0] if centred else enclose_in_box(servo))
    dark = [*_list_joint_balls(parts), *_list_waists(lateral, others, standing=standing)]
    lines = [half_space(UP_AXIS, (float(a.start[2]) + float(b.start[2])) / 2) for a, b in pairwise(lateral)]
    extreme_points = np.concatenate([member.extreme_points for member in parts])
    return Housing(
        blended_union(solids, 1.5 * BLEND_RADIUS),
        sharp_union(dark),
        tuple(lines),
        extreme_points,
        TRIANGLE_BUDGET["trunk"],
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


def _loft_capsules(lateral: Sequence[Capsule], *, standing: bool) -> DistanceField:
    """Return the distance field of a loft through lateral capsules.

    A single capsule gets some height. The loft of a moving part is extended down to the segment below.
    """
    heights = np.array([float(c.start[2]) for c in lateral])
    widths = np.array([abs(float((c.end - c.start)[1])) / 2 for c in lateral])
    radii = np.array([c.radius + SKIN_THICKNESS for c in lateral])
    if len(lateral) == 1:
        return loft(heights[0] + np.array([-0.3, 0.22]) * radii[0], np.tile(widths, 2), np.tile(radii, 2))
    if not standing:
        heights = np.insert(heights, 0, heights[0] - 0.3 * radii[0])
        widths, radii = np.insert(widths, 0, widths[0]), np.insert(radii, 0, radii[0])
    return loft(heights, widths, radii)


def _list_bars(shapes: Sequence[Capsule], *, standing: bool) -> Iterator[DistanceField]:
    """Yield bars along capsules, and a standing column's base plate."""
    for shape in shapes:
        yield cone(shape.start, shape.end, 0.95 * shape.radius, 0.95 * shape.radius)
    columns = [c for c in shapes if np.ptp([c.start[2], c.end[2]]) > 4 * c.radius]
    if standing and columns:
        radius = columns[0].radius
        lowest = min(columns[0].start, columns[0].end, key=lambda end: float(end[2]))
        yield drum(
            lowest - (radius - 2 * FOOT_PLATE[1]) * UP_AXIS,
            UP_AXIS,
            FOOT_PLATE[0] * radius,
            FOOT_PLATE[1],
            0.8 * FOOT_PLATE[1],
        )


def _list_waists(lateral: Sequence[Capsule], others: Sequence[Capsule], *, standing: bool) -> Iterator[DistanceField]:
    """Yield the dark regions of a trunk part.

    These are the neck, the lower end of a moving part and the upper end of a standing part.
    """
    if not lateral:
        return
    lowest, half_height = lateral[0], lateral[-1]
    if any(c.end[2] > half_height.start[2] + half_height.radius for c in others):
        yield half_space_above(float(half_height.start[2]) + 0.93 * half_height.radius)
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
    """Yield balls around the positions where arms begin."""
    for part in parts:
        arms = {name for side in SIDES for name in part.robot.arm(side).segments}
        for child in part.children:
            if child.name in arms and child.capsules:
                first = child.capsules[0]
                yield ball(part.origin + child.origin_in_parent + 0.5 * first.start, 0.9 * first.radius)
