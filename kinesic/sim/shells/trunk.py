"""The design of what stands, bends and looks: pelvis, trunk and head."""

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
    BLEND,
    BUDGET,
    FOOT,
    FRONT_RADIUS,
    SKIN,
    SOFT,
    VISOR,
    Housing,
    ShellPart,
    boxed,
    drum_about,
)

MIDLINE = 0.004  # [m] nearer to it is on it
SHAPE_SPACING = 0.005  # [m] between the heights of two lateral shapes, at least
UP = sealed([0.0, 0.0, 1.0])


def head(part: ShellPart) -> Housing:
    """A rounded block with a front that is bent about the upright axis, and a visor where the eyes are."""
    big, size = max(part.capsules, key=lambda c: c.radius), part.robot.arm_length
    middle, tall = (big.start + big.end) / 2, abs(float((big.end - big.start)[2])) / 2
    half = np.array([0.975 * big.radius, 1.08 * big.radius, tall + 0.99 * big.radius])
    block = box(middle, half, 0.72 * big.radius)
    eyes = part.robot.sites.get("eyes")
    bend = max(FRONT_RADIUS * size, 1.2 * big.radius)
    front = middle + (half[0] - bend) * np.array([1.0, 0.0, 0.0])
    solids = [rounded_intersection(block, drum(front, UP, bend, 4 * big.radius, 0.01), 0.008)]
    solids += [boxed(servo, 2 * SOFT) for servo in part.servos]
    seam = half_space(np.array([1.0, 0.0, 0.0]), float(middle[0] - 0.3 * big.radius))
    dark = None
    if eyes is not None and eyes.segment == part.segment.name and eyes.facing[0] > 0.9:
        dark = _visor(eyes.position, VISOR[0] * size, VISOR[1] * size)
    return Housing(blended_union(solids, 2.5 * BLEND), dark, (seam,), part.held, BUDGET["head"])


def _visor(eyes: Floats, wide: float, high: float) -> DistanceField:
    """Makes the solid in front of a rounded rectangle about the eyes."""

    def field(points: Floats) -> Floats:
        across, up = (points[:, 1] - eyes[1]) / wide, (points[:, 2] - eyes[2]) / high
        rim = ((across**4 + up**4) ** 0.25 - 1.0) * high
        return np.asarray(np.where(points[:, 0] > eyes[0] - 0.6 * wide, rim, high))

    return field


def trunk(part: ShellPart, moving: set[str]) -> Housing:
    """Designs the shell of a part of the trunk: a loft through lateral shapes, bars, and drums and boxes for servos."""
    parts, standing = list(_rigid(part, moving)), part.segment.parent is None
    capsules = [c for each in parts for c in each.capsules]
    lateral = _lateral(capsules)
    others = [c for c in capsules if c not in lateral]
    solids = [*_bars(others, standing=standing)]
    if lateral:
        solids.insert(0, _lofted(lateral, standing=standing))
    for servo in (servo for each in parts for servo in each.servos):
        centred = np.linalg.norm(servo.centre[:2]) < MIDLINE
        solids.append(drum_about(servo, servo.centre, UP)[0] if centred else boxed(servo))
    dark = [*_joints(parts), *_waists(lateral, others, standing=standing)]
    lines = [half_space(UP, (float(a.start[2]) + float(b.start[2])) / 2) for a, b in pairwise(lateral)]
    held = np.concatenate([each.held for each in parts])
    return Housing(blended_union(solids, 1.5 * BLEND), sharp_union(dark), tuple(lines), held, BUDGET["trunk"])


def _lateral(capsules: Sequence[Capsule]) -> list[Capsule]:
    """Picks the capsules that lie across the midline, from below, each clearly above the one before."""
    found: list[Capsule] = []
    for shape in sorted(capsules, key=lambda c: float(c.start[2])):
        way, middle = np.abs(shape.end - shape.start), (shape.start + shape.end) / 2
        across = way[1] >= way[2] and way[0] < MIDLINE and np.abs(middle[:2]).max() < MIDLINE
        if across and (not found or shape.start[2] - found[-1].start[2] > SHAPE_SPACING):
            found.append(shape)
    return found


def _lofted(lateral: Sequence[Capsule], *, standing: bool) -> DistanceField:
    """A trunk through its shapes: a single one gets some height, and what bends reaches down to what bears it."""
    heights = np.array([float(c.start[2]) for c in lateral])
    widths = np.array([abs(float((c.end - c.start)[1])) / 2 for c in lateral])
    radii = np.array([c.radius + SKIN for c in lateral])
    if len(lateral) == 1:
        return loft(heights[0] + np.array([-0.3, 0.22]) * radii[0], np.tile(widths, 2), np.tile(radii, 2))
    if not standing:
        heights = np.insert(heights, 0, heights[0] - 0.3 * radii[0])
        widths, radii = np.insert(widths, 0, widths[0]), np.insert(radii, 0, radii[0])
    return loft(heights, widths, radii)


def _bars(shapes: Sequence[Capsule], *, standing: bool) -> Iterator[DistanceField]:
    """Yields what is not lateral, a little slimmer, and the plate on which a column stands."""
    for shape in shapes:
        yield cone(shape.start, shape.end, 0.95 * shape.radius, 0.95 * shape.radius)
    columns = [c for c in shapes if np.ptp([c.start[2], c.end[2]]) > 4 * c.radius]
    if standing and columns:
        radius = columns[0].radius
        low = min(columns[0].start, columns[0].end, key=lambda end: float(end[2]))
        yield drum(low - (radius - 2 * FOOT[1]) * UP, UP, FOOT[0] * radius, FOOT[1], 0.8 * FOOT[1])


def _waists(lateral: Sequence[Capsule], others: Sequence[Capsule], *, standing: bool) -> Iterator[DistanceField]:
    """Yields what is dark: a neck, the lower end of what bends, the upper end of what bears it."""
    if not lateral:
        return
    low, high = lateral[0], lateral[-1]
    if any(c.end[2] > high.start[2] + high.radius for c in others):
        yield half_space_above(float(high.start[2]) + 0.93 * high.radius)
    yield (
        half_space_above(float(high.start[2]) + 0.85 * high.radius)
        if standing
        else half_space_below(float(low.start[2]) - 0.55 * low.radius)
    )


def _rigid(part: ShellPart, moving: set[str]) -> Iterator[ShellPart]:
    """Yields a part and all that is fixed to it."""
    yield part
    for child in part.children:
        if child.name not in moving:
            yield from _rigid(ShellPart(part.robot, child, sealed(part.origin + child.origin_in_parent)), moving)


def _joints(parts: Sequence[ShellPart]) -> Iterator[DistanceField]:
    """Yields balls about the places where arms begin."""
    for part in parts:
        arms = {name for side in SIDES for name in part.robot.arm(side).segments}
        for child in part.children:
            if child.name in arms and child.capsules:
                first = child.capsules[0]
                yield ball(part.origin + child.origin_in_parent + 0.5 * first.start, 0.9 * first.radius)
