"""Signed distance fields of simple solids and their blends: [m], negative inside."""

from collections.abc import Callable, Sequence

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.sim.shells.cross_sections import MonotoneCurve

DistanceField = Callable[[Floats], Floats]  # (n, 3) [m] -> (n,) [m]
GRADIENT_STEP = 2e-4  # [m] offset of the central difference on each side


def cone(start: Floats, end: Floats, first: float, last: float) -> DistanceField:
    """Return the signed distance field of a round-ended, tapered bar."""
    axis = end - start
    square = max(float(axis @ axis), 1e-12)

    def field(points: Floats) -> Floats:
        fraction = np.clip((points - start) @ axis / square, 0.0, 1.0)
        distance = np.linalg.norm(points - start - fraction[:, None] * axis, axis=1)
        return np.asarray(distance - first - fraction * (last - first))

    return field


def box(centre: Floats, half: Floats, rounding: float) -> DistanceField:
    """Return the signed distance field of an axis-aligned box with rounded edges."""
    core = np.maximum(half - rounding, 0.0)

    def field(points: Floats) -> Floats:
        excess = np.abs(points - centre) - core
        outside = np.linalg.norm(np.maximum(excess, 0.0), axis=1)
        return np.asarray(outside + np.minimum(excess.max(axis=1), 0.0) - rounding)

    return field


def drum(centre: Floats, axis: Floats, radius: float, half: float, rounding: float) -> DistanceField:
    """Return the signed distance field of a cylinder with rounded edges."""

    def field(points: Floats) -> Floats:
        along = (points - centre) @ axis
        distance = np.linalg.norm(points - centre - along[:, None] * axis, axis=1)
        excess = np.stack([distance - radius + rounding, np.abs(along) - half + rounding], axis=1)
        outside = np.linalg.norm(np.maximum(excess, 0.0), axis=1)
        return np.asarray(outside + np.minimum(excess.max(axis=1), 0.0) - rounding)

    return field


def loft(heights: Floats, widths: Floats, radii: Floats) -> DistanceField:
    """Return the signed distance field of a trunk with stadium-shaped cross-sections.

    The ends of the trunk are rounded.

    Args:
        heights: (k,) [m] increasing.
        widths: (k,) [m] from the midline to the start of the round flanks.
        radii: (k,) [m] of the flanks, half the depth.
    """
    sections = MonotoneCurve.through(heights, np.stack([widths, radii], axis=1))

    def field(points: Floats) -> Floats:
        x, y, z = points.T
        level = np.clip(z, heights[0], heights[-1])
        width_at_level, radius_at_level = sections.at(level).T
        excess = np.maximum(np.maximum(heights[0] - z, z - heights[-1]), 0.0)
        return np.asarray(
            np.sqrt(x**2 + np.maximum(np.abs(y) - width_at_level, 0.0) ** 2 + excess**2) - radius_at_level
        )

    return field


def sleeve(
    axes: Floats, along: Floats, half_widths: Floats, *, corner: float = 0.55, rounding: float = 0.01
) -> DistanceField:
    """Return the signed distance field of a limb with rounded rectangular cross-sections.

    Args:
        axes: (3, 3) unit vectors: two across the limb, and the one along it.
        along: (k,) [m] increasing positions along the limb.
        half_widths: (k, 2) [m] half the width along both axes across.
        corner: radius of the section's corners, relative to the smaller half width.
        rounding: [m] radius of the edges at both ends.
    """
    sections = MonotoneCurve.through(along, half_widths)
    middle, half = (along[0] + along[-1]) / 2, (along[-1] - along[0]) / 2

    def field(points: Floats) -> Floats:
        local = points @ axes.T
        widths = sections.at(np.clip(local[:, 2], along[0], along[-1]))
        radius = corner * widths.min(axis=1)
        excess = np.abs(local[:, :2]) - widths + radius[:, None]
        across = np.linalg.norm(np.maximum(excess, 0.0), axis=1) + np.minimum(excess.max(axis=1), 0.0) - radius
        both = np.stack([across + rounding, np.abs(local[:, 2] - middle) - half + rounding], axis=1)
        outside = np.linalg.norm(np.maximum(both, 0.0), axis=1)
        return np.asarray(outside + np.minimum(both.max(axis=1), 0.0) - rounding)

    return field


def blended_union(fields: Sequence[DistanceField], blend: float) -> DistanceField:
    """Return the union of solids, smoothed where distances differ below `blend` [m]."""

    def field(points: Floats) -> Floats:
        union = fields[0](points)
        for other in fields[1:]:
            value = other(points)
            nearness = np.maximum(blend - np.abs(union - value), 0.0) / blend
            union = np.minimum(union, value) - nearness**2 * blend / 4
        return union

    return field


def rounded_intersection(first: DistanceField, second: DistanceField, blend: float) -> DistanceField:
    """Return the intersection of two solids with edges rounded over `blend` [m]."""
    complement_union = blended_union([lambda points: -first(points), lambda points: -second(points)], blend)
    return lambda points: np.asarray(-complement_union(points))


def ball(centre: Floats, radius: float) -> DistanceField:
    """Return the signed distance field of a ball."""
    return lambda points: np.asarray(np.linalg.norm(points - centre, axis=1) - radius)


def half_space(axis: Floats, along: float) -> DistanceField:
    """Return the signed distance field of the half-space behind a plane.

    Args:
        axis: (3,) unit normal of the plane, which points out of the half-space.
        along: [m] offset of the plane along the normal.
    """
    return lambda points: np.asarray(points @ axis - along)


def half_space_above(height: float) -> DistanceField:
    """Return the signed distance field of the half-space above a height [m]."""
    return lambda points: np.asarray(height - points[:, 2])


def half_space_below(height: float) -> DistanceField:
    """Return the signed distance field of the half-space below a height [m]."""
    return lambda points: np.asarray(points[:, 2] - height)


def sharp_union(fields: Sequence[DistanceField]) -> DistanceField | None:
    """Return the sharp-edged union of solids, or None without solids."""
    if not fields:
        return None
    return lambda points: np.asarray(np.min([field(points) for field in fields], axis=0))


def gradient(field: DistanceField, points: Floats) -> Floats:
    """Compute the gradient of a distance field by central differences.

    Args:
        field: Signed distance.
        points: (n, 3) [m].

    Returns:
        (n, 3).
    """
    probes = GRADIENT_STEP * np.eye(3)
    return np.stack([field(points + probe) - field(points - probe) for probe in probes], axis=1) / (2 * GRADIENT_STEP)
