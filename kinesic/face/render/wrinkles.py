"""Wrinkles as height maps in the chart, drawn from the curves of `configs/faces/wrinkles.toml` (thesis 4.3.2).

Each furrow has the profile of a Mexican hat, so that skin piles up beside it, and runs out at its ends. The twelve maps
are those of Table 4.1; a picture shows their sum, each as strong as its action unit.
"""

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from kinesic.body.action_units import CHANNELS
from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import CONFIGS
from kinesic.face.assets.chart import LEFT_RIGHT, LOW_HIGH

FILE = CONFIGS / "faces" / "wrinkles.toml"
MAPS = 12
RESOLUTION = 512
SPAN = 10  # points of the drawn line between two given ones
REACH = 5.5  # half widths beyond which a furrow has no height
RIM = 1.35  # half widths from where the piled skin is lower
LOWERED = 0.9

MIRROR = np.array([-1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Curve:
    """One furrow in the chart."""

    points: Floats  # (k, 2) a and y
    width: float  # half, chart units
    depth: float  # 1 is usual at most
    mirrored: bool = False  # occurs on both sides

    def on_both_sides(self) -> tuple["Curve", ...]:
        """The curve and, where it is mirrored, its image."""
        return (self, self.image()) if self.mirrored else (self,)

    def image(self) -> "Curve":
        """The curve on the other side of the face."""
        return Curve(self.points * MIRROR, self.width, self.depth)


@dataclass(frozen=True)
class Wrinkle:
    """The furrows of an action unit."""

    unit: int
    maps: tuple[int, ...]  # of Table 4.1: one for the whole face, or the left and the right
    says: str
    curves: tuple[Curve, ...]  # of the left, where there are two maps


@cache
def wrinkles(path: Path = FILE) -> tuple[Wrinkle, ...]:
    """Reads the wrinkles of a file."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["wrinkle"]
    return tuple(
        Wrinkle(
            unit=entry["unit"],
            maps=tuple(entry["maps"]),
            says=entry["says"],
            curves=tuple(Curve(**each | {"points": sealed(each["points"])}) for each in entry["curves"]),
        )
        for entry in entries
    )


@cache
def maps(resolution: int = RESOLUTION) -> Floats:
    """Draws the wrinkle maps: (12, n, n) heights on a grid over the chart's window, first row at the bottom.

    A furrow of depth 1 is 1 deep; the skin beside it is raised by up to 0.4.
    """
    found = np.zeros((MAPS, resolution, resolution))
    for wrinkle in wrinkles():
        for curve in wrinkle.curves:
            for each in curve.on_both_sides():
                _dig(found[wrinkle.maps[0]], each)
            if len(wrinkle.maps) > 1:
                _dig(found[wrinkle.maps[1]], curve.image())
    return sealed(found)


@cache
def reaches() -> Floats:
    """(12, 2, 2) lowest and highest a and y at which each map has any height."""
    found = np.zeros((MAPS, 2, 2))
    low, span = np.array([LEFT_RIGHT[0], LOW_HIGH[0]]), np.array([np.ptp(LEFT_RIGHT), np.ptp(LOW_HIGH)])
    for number, height in enumerate(maps()):
        rows, columns = np.nonzero(height)
        ends = np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]])
        found[number] = low + ends * span / len(height)
    return sealed(found)


def shares(told: Floats) -> Floats:
    """Gives how much of each map is shown, on the left and on the right half of the face, (2, 12).

    Args:
        told: (c,) intensity of each of `CHANNELS`.
    """
    found = np.zeros((2, MAPS))
    for wrinkle in wrinkles():
        left, right = (told[CHANNELS.index(f"{side}{wrinkle.unit}")] for side in "LR")
        if len(wrinkle.maps) == 1:
            found[:, wrinkle.maps[0]] = left, right
        else:
            found[:, wrinkle.maps[0]], found[:, wrinkle.maps[1]] = left, right
    return found


def _dig(height: Floats, curve: Curve) -> None:
    resolution = len(height)
    low = np.array([LEFT_RIGHT[0], LOW_HIGH[0]])
    step = np.array([np.ptp(LEFT_RIGHT), np.ptp(LOW_HIGH)]) / resolution
    line = smooth_line(curve.points)
    reach = REACH * curve.width
    first = np.maximum(np.floor((line.min(axis=0) - reach - low) / step), 0).astype(int)
    last = np.minimum(np.ceil((line.max(axis=0) + reach - low) / step), resolution).astype(int)
    a, y = (low[k] + (np.arange(first[k], last[k]) + 0.5) * step[k] for k in (0, 1))
    grid = np.stack(np.meshgrid(a, y), axis=-1)
    away, along = _nearest(grid.reshape(-1, 2), line)
    u = away / curve.width
    hat = -(1 - 0.55 * u * u) * np.exp(-u * u / 2) * np.where(u > RIM, LOWERED, 1.0)
    taper = np.sin(np.pi * along) ** 0.7 * (1 - np.exp(-12 * np.minimum(along, 1 - along)))
    dug = curve.depth * np.where(u < REACH, hat * taper, 0.0)
    height[first[1] : last[1], first[0] : last[0]] += dug.reshape(len(y), len(a))


def smooth_line(points: Floats) -> Floats:
    """Runs a Catmull-Rom spline through (k, 2) points, (n, 2)."""
    padded = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    t = np.linspace(0.0, 1.0, SPAN, endpoint=False)[:, None]
    spans = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        spans.append(b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))))
    return np.concatenate([*spans, points[-1:]])


def _nearest(points: Floats, line: Floats) -> tuple[Floats, Floats]:
    """(n,) distance of (n, 2) points from a line, and (n,) how far along it the nearest point lies, 0..1."""
    start, way = line[:-1], np.diff(line, axis=0)
    lengths = np.linalg.norm(way, axis=1)
    before = np.concatenate([[0.0], np.cumsum(lengths)])
    squares = lengths * lengths
    projected = points @ way.T - (start * way).sum(axis=1)
    share = np.clip(projected / squares, 0.0, 1.0)
    away = (points * points).sum(axis=1)[:, None] - 2 * points @ start.T + (start * start).sum(axis=1)
    away += share * (share * squares - 2 * projected)
    nearest = away.argmin(axis=1)
    rows = np.arange(len(points))
    along = (before[nearest] + share[rows, nearest] * lengths[nearest]) / before[-1]
    return np.sqrt(np.maximum(away[rows, nearest], 0.0)), along
