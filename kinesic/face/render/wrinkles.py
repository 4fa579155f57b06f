"""Wrinkles of the face skin as height maps (thesis 4.3.2).

They are drawn from the curves in `configs/faces/wrinkles.toml`. Each furrow has the profile of a Mexican hat, so that
skin is raised next to it, and tapers at its ends. The first twelve maps are those of Table 4.1; a picture shows the sum
of all maps weighted by the intensities of their action units: their heights are drawn over the G-buffer and bend its
normals.
"""

import tomllib
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from kinesic.body.action_units import FACE_CHANNELS, unit_channels
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.config import CONFIGS
from kinesic.face.assets.chart import (
    CHART_WIDTH,
    WINDOW_LEFT_RIGHT,
    WINDOW_LOW_HIGH,
    compute_chart_window,
    compute_vertex_chart,
)
from kinesic.face.assets.mesh import MESH_PARTS, Mesh
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Texture
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import ScreenPass, StoredPixels, Target, Value, make_texture, store_pixels

WRINKLE_FILE = CONFIGS / "faces" / "wrinkles.toml"
MAP_COUNT = 16  # number of wrinkle maps
MAP_RESOLUTION = 512  # [pixels] width and height of a wrinkle map
POINTS_PER_SPAN = 10  # interpolated points between two control points
FURROW_REACH = 5.5  # [half widths] distance from its centre at which a furrow ends
RIM_START = 1.35  # [half widths] distance from a furrow's centre from which its raised rim is lowered
RIM_FACTOR = 0.9  # height factor of a furrow's lowered rim

MIRROR_FACTORS = np.array([-1.0, 1.0])  # signs of the chart coordinates a and y in a mirror image
WRINKLE_HEIGHT = 0.022  # [eye distances] height of a wrinkle of depth 1
MAPS_PER_TEXTURE = 4  # wrinkle maps per texture, one per colour component


@dataclass(frozen=True, eq=False)
class Curve:
    """Centre line of one furrow of the face skin."""

    points: Floats  # (k, 2) chart a and y
    width: float  # half width in chart units
    depth: float  # factor on the height, usually at most 1
    mirrored: bool = False  # whether the furrow occurs on both sides

    def on_both_sides(self) -> tuple["Curve", ...]:
        """Return the furrow's curve and, if mirrored, its mirror image."""
        return (self, self.image()) if self.mirrored else (self,)

    def image(self) -> "Curve":
        """Return the furrow's curve mirrored to the other side."""
        return Curve(self.points * MIRROR_FACTORS, self.width, self.depth)


@dataclass(frozen=True)
class Wrinkle:
    """Furrows of one action unit."""

    unit: int
    maps: tuple[int, ...]  # one map for the whole face, or one per side
    says: str
    curves: tuple[Curve, ...]  # left side only if there are two maps


@cache
def load_wrinkles(path: Path = WRINKLE_FILE) -> tuple[Wrinkle, ...]:
    """Read the wrinkles of all action units from a file."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["wrinkle"]
    return tuple(
        Wrinkle(
            unit=entry["unit"],
            maps=tuple(entry["maps"]),
            says=entry["says"],
            curves=tuple(Curve(**curve | {"points": sealed(curve["points"])}) for curve in entry["curves"]),
        )
        for entry in entries
    )


@cache
def draw_wrinkle_maps(resolution: int = MAP_RESOLUTION) -> Floats:
    """Return the (16, n, n) heights of the wrinkle maps.

    They cover the window of the chart.

    The first row is the bottom row. A furrow of depth 1 is 1 deep; the skin next to it is raised by up to 0.4.
    """
    heights = np.zeros((MAP_COUNT, resolution, resolution))
    for wrinkle in load_wrinkles():
        for curve in wrinkle.curves:
            for side_curve in curve.on_both_sides():
                _add_furrow(heights[wrinkle.maps[0]], side_curve)
            if len(wrinkle.maps) > 1:
                _add_furrow(heights[wrinkle.maps[1]], curve.image())
    return sealed(heights)


@cache
def find_map_extents() -> Floats:
    """Return the (16, 2, 2) bounding box of each wrinkle map.

    It holds the lowest and highest a and y.
    """
    extents = np.zeros((MAP_COUNT, 2, 2))
    low, span = (
        np.array([WINDOW_LEFT_RIGHT[0], WINDOW_LOW_HIGH[0]]),
        np.array([np.ptp(WINDOW_LEFT_RIGHT), np.ptp(WINDOW_LOW_HIGH)]),
    )
    for number, height in enumerate(draw_wrinkle_maps()):
        rows, columns = np.nonzero(height)
        ends = np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]])
        extents[number] = low + ends * span / len(height)
    return sealed(extents)


def compute_map_strengths(channels: Floats) -> Floats:
    """Return the (2, 16) weights of wrinkle maps on both half faces.

    The left half comes first.

    Args:
        channels: (c,) intensity of each of `FACE_CHANNELS`.
    """
    strengths = np.zeros((2, MAP_COUNT))
    for wrinkle in load_wrinkles():
        unit_names = unit_channels(wrinkle.unit)
        left, right = channels[FACE_CHANNELS.index(unit_names[0])], channels[FACE_CHANNELS.index(unit_names[-1])]
        if len(wrinkle.maps) == 1:
            strengths[:, wrinkle.maps[0]] = left, right
        else:
            strengths[:, wrinkle.maps[0]], strengths[:, wrinkle.maps[1]] = left, right
    return strengths


def _add_furrow(height: Floats, curve: Curve) -> None:
    low = np.array([WINDOW_LEFT_RIGHT[0], WINDOW_LOW_HIGH[0]])
    step = np.array([np.ptp(WINDOW_LEFT_RIGHT), np.ptp(WINDOW_LOW_HIGH)]) / len(height)
    a, y = (low + (np.arange(len(height)) + 0.5)[:, None] * step).T
    line, reach = interpolate_line(curve.points), FURROW_REACH * curve.width
    rows, columns = _find_window(line, reach, a, y)
    away, along = _find_nearest(line, reach, a[columns], y[rows])
    u = away / curve.width
    hat = -(1 - 0.55 * u * u) * np.exp(-u * u / 2) * np.where(u > RIM_START, RIM_FACTOR, 1.0)
    taper = np.sin(np.pi * along) ** 0.7 * (1 - np.exp(-12 * np.minimum(along, 1 - along)))
    height[rows, columns] += curve.depth * np.where(away < reach, hat * taper, 0.0)


def interpolate_line(points: Floats) -> Floats:
    """Interpolate (k, 2) points with a Catmull-Rom spline, shape (n, 2)."""
    padded = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    t = np.linspace(0.0, 1.0, POINTS_PER_SPAN, endpoint=False)[:, None]
    spans = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        spans.append(b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))))
    return np.concatenate([*spans, points[-1:]])


def _find_window(points: Floats, reach: float, a: Floats, y: Floats) -> tuple[slice, slice]:
    """Return slices of the map rows and columns around points."""
    ends = np.stack([points.min(axis=0) - reach, points.max(axis=0) + reach])
    rows, columns = (slice(*np.searchsorted(grid, ends[:, k])) for grid, k in ((y, 1), (a, 0)))
    return rows, columns


def _find_nearest(line: Floats, reach: float, a: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return grid points' distances from a line and positions along the line.

    Both have shape (rows, columns). Distances are at most `reach`.
    """
    squares, along = np.full((len(y), len(a)), reach * reach), np.zeros((len(y), len(a)))
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    for first, last in pairwise(range(len(line))):
        part = _find_window(line[[first, last]], reach, a, y)
        right, up = a[part[1]] - line[first, 0], (y[part[0]] - line[first, 1])[:, None]
        segment = line[last] - line[first]
        fraction = np.clip((right * segment[0] + up * segment[1]) / (segment @ segment), 0.0, 1.0)
        square = (right - fraction * segment[0]) ** 2 + (up - fraction * segment[1]) ** 2
        nearer = square < squares[part]
        np.copyto(squares[part], square, where=nearer)
        np.copyto(along[part], lengths[first] + fraction * (lengths[last] - lengths[first]), where=nearer)
    return np.sqrt(squares), along / lengths[-1]


class WrinklePass:
    """Pass that bends the normals of a head at its wrinkles."""

    def __init__(self, context: GlContext, geometry: Geometry, *, wrinkled: bool = True) -> None:
        """Load the wrinkle maps and compile their shaders.

        Args:
            context: OpenGL context.
            geometry: G-buffer of the head.
            wrinkled: whether there are wrinkles; otherwise nothing is loaded or bent.
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
            self._maps = [make_texture(context, packed) for packed in _pack_maps()]
            number, self._near = np.nonzero(_find_wrinkled_vertices(geometry.mesh, geometry.drawn_on))
            self._first = np.searchsorted(number, np.arange(MAP_COUNT))

    def draw(self, shown: Floats) -> tuple[Texture, Texture]:
        """Draw wrinkle heights, and the normals bent at wrinkles.

        Args:
            shown: (2, 16) weight of each wrinkle map on the left and right half of the face.

        Returns:
            The texture of heights, and the first texture of the G-buffer with bent normals.
        """
        form, place = self._geometry.target.textures
        relief = self._relief.clear().textures[0]
        if not (self._maps and shown.any()):  # the usual case of a talking face
            return relief, form
        corners = self._compute_map_boxes()
        for first, drawn in zip(range(0, MAP_COUNT, MAPS_PER_TEXTURE), self._maps, strict=True):
            left, right = shown[:, first : first + MAPS_PER_TEXTURE]
            here = np.flatnonzero((left + right) > 0.0)
            if len(here):
                values: dict[str, Value] = {"left": left, "right": right, "chart": compute_chart_window()}
                within = self._geometry.rectangle(corners[:, here + first].reshape(2, -1))
                inputs = {"form": form, "place": place, "maps": drawn}
                self._relief.draw(inputs, values, within=within, added=True)
        self._bend.target.copy(self._unbent)
        within = self._geometry.rectangle(corners[:, shown.any(axis=0)].reshape(2, -1))
        values = {"lens": self._geometry.lens, "pixel": self._pixel, "bump": WRINKLE_HEIGHT * self._unit}
        bent = self._bend.draw({"form": form, "relief": relief}, values, within=within)
        return relief, bent.textures[0]

    def _compute_map_boxes(self) -> Floats:
        """Return the (2, 16, 2) screen bounding box of each wrinkle map."""
        points = self._geometry.on_screen.take(self._near, axis=1)
        ends = (reduction.reduceat(points, self._first, axis=1) for reduction in (np.minimum, np.maximum))
        return np.stack(list(ends), axis=2)


@cache
def _pack_maps() -> tuple[StoredPixels, ...]:
    """Return the wrinkle maps as (n, n, 4) textures."""
    packed = np.moveaxis(draw_wrinkle_maps(), 0, -1)
    return tuple(
        store_pixels(packed[..., first : first + MAPS_PER_TEXTURE], "f2")
        for first in range(0, MAP_COUNT, MAPS_PER_TEXTURE)
    )


@lru_cache(maxsize=4)
def _find_wrinkled_vertices(mesh: Mesh, drawn_on: Mesh) -> Flags:
    """Return (16, v) flags of vertices whose triangles touch each wrinkle map."""
    corners = compute_vertex_chart(drawn_on)[mesh.triangles, :2]
    low, high = corners.min(axis=1), corners.max(axis=1)
    whole = (high - low)[:, 0] < CHART_WIDTH / 2  # not split by the chart's seam
    flags = np.zeros((MAP_COUNT, len(mesh.positions)), dtype=bool)
    for near, (lowest, highest) in zip(flags, find_map_extents(), strict=True):
        near[mesh.triangles[whole & np.all((low < highest) & (high > lowest), axis=1)]] = True
    return np.asarray(flags & (mesh.parts == MESH_PARTS.index("skin")))
