"""Signed distances of simple solids, and how they flow into one another: less than 0 inside, [m]."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.interpolate import PchipInterpolator

from kinesic.body.arrays import Floats

DistanceField = Callable[[Floats], Floats]  # (n, 3) [m] -> (n,) [m]
PROBE = 2e-4  # [m] on each side of a place where a gradient is taken


def cone(start: Floats, end: Floats, first: float, last: float) -> DistanceField:
    """Makes a bar with round ends, whose radius goes from one to another."""
    way = end - start
    square = max(float(way @ way), 1e-12)

    def field(points: Floats) -> Floats:
        share = np.clip((points - start) @ way / square, 0.0, 1.0)
        away = np.linalg.norm(points - start - share[:, None] * way, axis=1)
        return np.asarray(away - first - share * (last - first))

    return field


def box(centre: Floats, half: Floats, rounding: float) -> DistanceField:
    """Makes a box with rounded edges, along the axes."""
    core = np.maximum(half - rounding, 0.0)

    def field(points: Floats) -> Floats:
        beyond = np.abs(points - centre) - core
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        return np.asarray(outside + np.minimum(beyond.max(axis=1), 0.0) - rounding)

    return field


def drum(centre: Floats, axis: Floats, radius: float, half: float, rounding: float) -> DistanceField:
    """Makes a cylinder with rounded edges."""

    def field(points: Floats) -> Floats:
        along = (points - centre) @ axis
        away = np.linalg.norm(points - centre - along[:, None] * axis, axis=1)
        beyond = np.stack([away - radius + rounding, np.abs(along) - half + rounding], axis=1)
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        return np.asarray(outside + np.minimum(beyond.max(axis=1), 0.0) - rounding)

    return field


def loft(heights: Floats, widths: Floats, radii: Floats) -> DistanceField:
    """A trunk: at each height a stadium, as wide as told and with round flanks; round above and below.

    Args:
        heights: (k,) [m] increasing.
        widths: (k,) [m] from the midline to where the flanks begin to be round.
        radii: (k,) [m] of the flanks, half the depth.
    """
    wider, deeper = (PchipInterpolator(heights, values) for values in (widths, radii))

    def field(points: Floats) -> Floats:
        x, y, z = points.T
        level = np.clip(z, heights[0], heights[-1])
        wide, deep = wider(level), deeper(level)
        beyond = np.maximum(np.maximum(heights[0] - z, z - heights[-1]), 0.0)
        return np.asarray(np.sqrt(x**2 + np.maximum(np.abs(y) - wide, 0.0) ** 2 + beyond**2) - deep)

    return field


def blended_union(fields: Sequence[DistanceField], blend: float) -> DistanceField:
    """Unites solids, which flow into one another where they are nearer than `blend` [m]."""

    def field(points: Floats) -> Floats:
        found = fields[0](points)
        for other in fields[1:]:
            value = other(points)
            near = np.maximum(blend - np.abs(found - value), 0.0) / blend
            found = np.minimum(found, value) - near**2 * blend / 4
        return found

    return field


def rounded_intersection(first: DistanceField, second: DistanceField, blend: float) -> DistanceField:
    """Intersects two solids, and rounds the edges in which they meet over `blend` [m]."""
    either = blended_union([lambda points: -first(points), lambda points: -second(points)], blend)
    return lambda points: np.asarray(-either(points))


def ball(centre: Floats, radius: float) -> DistanceField:
    """Makes a ball."""
    return lambda points: np.asarray(np.linalg.norm(points - centre, axis=1) - radius)


def half_space(axis: Floats, along: float) -> DistanceField:
    """Makes the half-space behind a plane that is normal to a unit axis, so far along it [m]."""
    return lambda points: np.asarray(points @ axis - along)


def half_space_above(height: float) -> DistanceField:
    """Makes the half-space above a height [m]."""
    return lambda points: np.asarray(height - points[:, 2])


def half_space_below(height: float) -> DistanceField:
    """Makes the half-space below a height [m]."""
    return lambda points: np.asarray(points[:, 2] - height)


def sharp_union(fields: Sequence[DistanceField]) -> DistanceField | None:
    """Unites solids, whose edges stay sharp; None where there is no solid."""
    if not fields:
        return None
    return lambda points: np.asarray(np.min([field(points) for field in fields], axis=0))


def gradient(field: DistanceField, points: Floats) -> Floats:
    """Computes the gradient (n, 3) of a field at (n, 3) places [m], by central differences."""
    probes = PROBE * np.eye(3)
    return np.stack([field(points + probe) - field(points - probe) for probe in probes], axis=1) / (2 * PROBE)
