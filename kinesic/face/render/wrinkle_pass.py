"""Wrinkles on the screen: their heights over the G-buffer, and the normals that they bend (thesis 4.3.2)."""

from functools import cache, lru_cache

import moderngl
import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.face.assets.chart import ROUND, chart_window, vertex_chart
from kinesic.face.assets.mesh import PARTS, Mesh
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import ScreenPass, Stored, Target, Value, store_pixels, texture
from kinesic.face.render.wrinkles import MAPS, maps, reaches

BUMP = 0.022  # height of a wrinkle of depth 1, in distances between the eyes
GROUP = 4  # maps in a texture


class WrinklePass:
    """Bends the normals of a head where it has wrinkles."""

    def __init__(self, context: moderngl.Context, geometry: Geometry, *, wrinkled: bool = True) -> None:
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
        self._maps: list[moderngl.Texture] = []
        if wrinkled:
            self._maps = [texture(context, each) for each in _packed()]
            number, self._near = np.nonzero(_wrinkled(geometry.mesh, geometry.drawn_on))
            self._first = np.searchsorted(number, np.arange(MAPS))

    def draw(self, shown: Floats) -> tuple[moderngl.Texture, moderngl.Texture]:
        """Draws heights of wrinkles over the G-buffer that was just drawn, and its first texture with bent normals.

        Args:
            shown: (2, 12) how much of each wrinkle map, on the left and on the right half of the face.
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
        """(2, 12, 2) lowest and highest of the screen's coordinates that each map may reach."""
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
    """(12, v) which vertices belong to a triangle that has something of each wrinkle map."""
    corners = vertex_chart(drawn_on)[mesh.triangles, :2]
    low, high = corners.min(axis=1), corners.max(axis=1)
    whole = (high - low)[:, 0] < ROUND / 2  # not cut by the chart's seam
    found = np.zeros((MAPS, len(mesh.positions)), dtype=bool)
    for near, (lowest, highest) in zip(found, reaches(), strict=True):
        near[mesh.triangles[whole & np.all((low < highest) & (high > lowest), axis=1)]] = True
    return np.asarray(found & (mesh.parts == PARTS.index("skin")))
