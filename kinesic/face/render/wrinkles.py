"""Wrinkles as height maps in the chart, drawn from the curves of `configs/faces/wrinkles.toml` (thesis 4.3.2).

Each furrow has the profile of a Mexican hat, so that skin piles up beside it, and runs out at its ends. The first
twelve maps are those of Table 4.1; a picture shows the sum of all, each as strong as its action unit: their heights are
drawn over the G-buffer, whose normals they bend.
"""

import tomllib
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from kinesic.body.action_units import CHANNELS, channels
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.config import CONFIGS
from kinesic.face.assets.chart import CHART_WIDTH, LEFT_RIGHT, LOW_HIGH, chart_window, vertex_chart
from kinesic.face.assets.mesh import PARTS, Mesh
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Texture
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import ScreenPass, Stored, Target, Value, store_pixels, texture

FILE = CONFIGS / "faces" / "wrinkles.toml"
MAPS = 16
RESOLUTION = 512
SPAN = 10  # points of the drawn line between two given ones
REACH = 5.5  # half widths beyond which a furrow has no height
RIM = 1.35  # half widths from where the piled skin is lower
LOWERED = 0.9

MIRROR = np.array([-1.0, 1.0])
BUMP = 0.022  # height of a wrinkle of depth 1, in distances between the eyes
GROUP = 4  # maps in a texture


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
    maps: tuple[int, ...]  # one for the whole face, or the left and the right
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
    """Draws the wrinkle maps: (16, n, n) heights on a grid over the chart's window, first row at the bottom.

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
    """(16, 2, 2) lowest and highest a and y at which each map has any height."""
    found = np.zeros((MAPS, 2, 2))
    low, span = np.array([LEFT_RIGHT[0], LOW_HIGH[0]]), np.array([np.ptp(LEFT_RIGHT), np.ptp(LOW_HIGH)])
    for number, height in enumerate(maps()):
        rows, columns = np.nonzero(height)
        ends = np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]])
        found[number] = low + ends * span / len(height)
    return sealed(found)


def shares(told: Floats) -> Floats:
    """Gives how much of each map is shown, on the left and on the right half of the face, (2, 16).

    Args:
        told: (c,) intensity of each of `CHANNELS`.
    """
    found = np.zeros((2, MAPS))
    for wrinkle in wrinkles():
        own = channels(wrinkle.unit)
        left, right = told[CHANNELS.index(own[0])], told[CHANNELS.index(own[-1])]
        if len(wrinkle.maps) == 1:
            found[:, wrinkle.maps[0]] = left, right
        else:
            found[:, wrinkle.maps[0]], found[:, wrinkle.maps[1]] = left, right
    return found


def _dig(height: Floats, curve: Curve) -> None:
    low = np.array([LEFT_RIGHT[0], LOW_HIGH[0]])
    step = np.array([np.ptp(LEFT_RIGHT), np.ptp(LOW_HIGH)]) / len(height)
    a, y = (low + (np.arange(len(height)) + 0.5)[:, None] * step).T
    line, reach = smooth_line(curve.points), REACH * curve.width
    rows, columns = _near(line, reach, a, y)
    away, along = _nearest(line, reach, a[columns], y[rows])
    u = away / curve.width
    hat = -(1 - 0.55 * u * u) * np.exp(-u * u / 2) * np.where(u > RIM, LOWERED, 1.0)
    taper = np.sin(np.pi * along) ** 0.7 * (1 - np.exp(-12 * np.minimum(along, 1 - along)))
    height[rows, columns] += curve.depth * np.where(away < reach, hat * taper, 0.0)


def smooth_line(points: Floats) -> Floats:
    """Runs a Catmull-Rom spline through (k, 2) points, (n, 2)."""
    padded = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    t = np.linspace(0.0, 1.0, SPAN, endpoint=False)[:, None]
    spans = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        spans.append(b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))))
    return np.concatenate([*spans, points[-1:]])


def _near(points: Floats, reach: float, a: Floats, y: Floats) -> tuple[slice, slice]:
    """Rows at y and columns at a that hold all that is within reach of some points."""
    ends = np.stack([points.min(axis=0) - reach, points.max(axis=0) + reach])
    rows, columns = (slice(*np.searchsorted(each, ends[:, k])) for each, k in ((y, 1), (a, 0)))
    return rows, columns


def _nearest(line: Floats, reach: float, a: Floats, y: Floats) -> tuple[Floats, Floats]:
    """(rows, columns) distance from a line, the reach at most, and how far along it the nearest point lies, 0..1."""
    squares, along = np.full((len(y), len(a)), reach * reach), np.zeros((len(y), len(a)))
    before = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    for first, last in pairwise(range(len(line))):
        part = _near(line[[first, last]], reach, a, y)
        right, up = a[part[1]] - line[first, 0], (y[part[0]] - line[first, 1])[:, None]
        way = line[last] - line[first]
        share = np.clip((right * way[0] + up * way[1]) / (way @ way), 0.0, 1.0)
        square = (right - share * way[0]) ** 2 + (up - share * way[1]) ** 2
        nearer = square < squares[part]
        np.copyto(squares[part], square, where=nearer)
        np.copyto(along[part], before[first] + share * (before[last] - before[first]), where=nearer)
    return np.sqrt(squares), along / before[-1]


class WrinklePass:
    """Bends the normals of a head where it has wrinkles."""

    def __init__(self, context: GlContext, geometry: Geometry, *, wrinkled: bool = True) -> None:
        """Loads the wrinkle maps.

        Args:
            context: to draw in.
            geometry: of the head.
            wrinkled: else nothing is loaded, and nothing bent.
        """

        def over_head(fragment: str, kind: str) -> ScreenPass:
            return ScreenPass(context, Target(context, geometry.size, (kind,), geometry.depth), "form", fragment)

        self._geometry = geometry
        self._relief, self._bend = over_head("relief", "1f4"), over_head("bend", "4f4")
        self._unbent = Target.of(context, geometry.target.textures[:1], None)
        self._pixel = tuple(1.0 / side for side in geometry.size)
        self._unit = float(geometry.mesh.eyes[0, 1] - geometry.mesh.eyes[1, 1])
        self._maps: list[Texture] = []
        if wrinkled:
            self._maps = [texture(context, each) for each in _packed()]
            number, self._near = np.nonzero(_wrinkled(geometry.mesh, geometry.drawn_on))
            self._first = np.searchsorted(number, np.arange(MAPS))

    def draw(self, shown: Floats) -> tuple[Texture, Texture]:
        """Draws heights of wrinkles over the G-buffer that was just drawn, and its first texture with bent normals.

        Args:
            shown: (2, 16) how much of each wrinkle map, on the left and on the right half of the face.
        """
        form, place = self._geometry.target.textures
        relief = self._relief.clear().textures[0]
        if not (self._maps and shown.any()):  # most of the time nothing is, in a face that talks
            return relief, form
        corners = self._corners()
        for first, drawn in zip(range(0, MAPS, GROUP), self._maps, strict=True):
            left, right = shown[:, first : first + GROUP]
            here = np.flatnonzero((left + right) > 0.0)
            if len(here):
                values: dict[str, Value] = {"left": left, "right": right, "chart": chart_window()}
                within = self._geometry.rectangle(corners[:, here + first].reshape(2, -1))
                inputs = {"form": form, "place": place, "maps": drawn}
                self._relief.draw(inputs, values, within=within, added=True)
        self._bend.target.copy(self._unbent)
        within = self._geometry.rectangle(corners[:, shown.any(axis=0)].reshape(2, -1))
        values = {"lens": self._geometry.lens, "pixel": self._pixel, "bump": BUMP * self._unit}
        bent = self._bend.draw({"form": form, "relief": relief}, values, within=within)
        return relief, bent.textures[0]

    def _corners(self) -> Floats:
        """(2, 16, 2) lowest and highest of the screen's coordinates that each map may reach."""
        points = self._geometry.on_screen.take(self._near, axis=1)
        ends = (each.reduceat(points, self._first, axis=1) for each in (np.minimum, np.maximum))
        return np.stack(list(ends), axis=2)


@cache
def _packed() -> tuple[Stored, ...]:
    """(n, n, 4) the wrinkle maps as textures hold them."""
    packed = np.moveaxis(maps(), 0, -1)
    return tuple(store_pixels(packed[..., first : first + GROUP], "f2") for first in range(0, MAPS, GROUP))


@lru_cache(maxsize=4)
def _wrinkled(mesh: Mesh, drawn_on: Mesh) -> Flags:
    """(16, v) which vertices belong to a triangle that has something of each wrinkle map."""
    corners = vertex_chart(drawn_on)[mesh.triangles, :2]
    low, high = corners.min(axis=1), corners.max(axis=1)
    whole = (high - low)[:, 0] < CHART_WIDTH / 2  # not cut by the chart's seam
    found = np.zeros((MAPS, len(mesh.positions)), dtype=bool)
    for near, (lowest, highest) in zip(found, reaches(), strict=True):
        near[mesh.triangles[whole & np.all((low < highest) & (high > lowest), axis=1)]] = True
    return np.asarray(found & (mesh.parts == PARTS.index("skin")))
