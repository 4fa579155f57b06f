"""Wrinkles on the screen: their heights over the G-buffer, and the normals that they bend (thesis 4.3.2)."""

import moderngl
import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats
from kinesic.face.chart import window
from kinesic.face.geometry import Geometry
from kinesic.face.mesh import PARTS
from kinesic.face.passes import ScreenPass, Target, Value, texture
from kinesic.face.wrinkles import MAPS, maps, reaches

BUMP = 0.022  # height of a wrinkle of depth 1, in distances between the eyes
GROUP = 4  # maps in a texture
COARSEST = 0.25  # width of a face of the mesh, in the chart


class ReliefPass:
    """Bends the normals of a head."""

    def __init__(self, context: moderngl.Context, geometry: Geometry) -> None:
        def over_head(fragment: str, kind: str) -> ScreenPass:
            return ScreenPass(context, fragment, Target(context, geometry.size, (kind,), geometry.depth))

        self._geometry = geometry
        self._relief, self._bend = over_head("relief", "1f4"), over_head("bend", "4f4")
        self._pixel = tuple(1.0 / side for side in geometry.size)
        self._unit = float(geometry.mesh.eyes[0, 1] - geometry.mesh.eyes[1, 1])
        packed = np.moveaxis(maps(), 0, -1)
        self._maps = [texture(context, packed[..., first : first + GROUP]) for first in range(0, MAPS, GROUP)]
        chart = geometry.place[:, :2]
        low, high = np.moveaxis(reaches(), 1, 0)[:, :, None]
        near = np.all((chart > low - COARSEST) & (chart < high + COARSEST), axis=2)
        self._near = near & (geometry.mesh.parts == PARTS.index("skin"))

    def draw(self, shown: Floats) -> tuple[moderngl.Texture, moderngl.Texture]:
        """Heights of the wrinkles, and unit normals bent by them, over the G-buffer that was just drawn.

        Args:
            shown: (2, 12) how much of each wrinkle map, on the left and on the right half of the face.
        """
        position, normal, place = self._geometry.target.textures
        relief = self._relief.clear().textures[0]
        if not shown.any():  # most of the time nothing is, in a face that talks
            return relief, normal
        for first, drawn in zip(range(0, MAPS, GROUP), self._maps, strict=True):
            left, right = shown[:, first : first + GROUP]
            here = np.flatnonzero((left + right) > 0.0)
            if len(here):
                values: dict[str, Value] = {"left": left, "right": right, "chart": window()}
                within = self._geometry.rectangle(self._under(here + first))
                inputs = {"position": position, "place": place, "maps": drawn}
                self._relief.draw(inputs, values, within=within, added=True)
        self._bend.target.copy(normal)
        within = self._geometry.rectangle(self._under(np.flatnonzero(shown.any(axis=0))))
        inputs = {"position": position, "normal": normal, "relief": relief}
        bent = self._bend.draw(inputs, {"pixel": self._pixel, "bump": BUMP * self._unit}, within=within)
        return relief, bent.textures[0]

    def _under(self, numbers: NDArray[np.intp]) -> Flags:
        """(v,) which vertices some of the wrinkle maps may reach."""
        return np.asarray(self._near[numbers].any(axis=0))
