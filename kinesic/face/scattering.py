"""Light that spreads under the skin (thesis 5.1), where occlusion says that the surface curves (5.2).

Wrinkles and the edges of shadows are too fine for occlusion to tell; what they make uneven is filtered, too.
"""

import moderngl

from kinesic.face.geometry import Geometry
from kinesic.face.passes import Marks, ScreenPass, Target, Value
from kinesic.face.presets import Scattering


class ScatterPass:
    """Filters diffuse light in place, along one axis and then along the other."""

    def __init__(self, context: moderngl.Context, geometry: Geometry, lit: Target, scattering: Scattering) -> None:
        self.scattering, self._lit, self._position = scattering, lit, geometry.target.textures[0]
        self._pixel = [1.0 / side for side in geometry.size]
        self._marks = Marks(context, "mark_skin", geometry.size)
        diffuse, uneven = lit.textures
        self._uneven = Target.of(context, [uneven], None)
        self._half = Target(context, geometry.size, ("4f4",), self._marks.depth)
        back = Target.of(context, [diffuse], self._marks.depth)
        self._across = ScreenPass(context, "scatter", self._half, where="marked")
        self._up = ScreenPass(context, "scatter", back, where="marked")

    def clear(self) -> None:
        """Nothing is uneven, before light is drawn."""
        self._uneven.frame.clear()

    def draw(self, bent: moderngl.Texture, scale: float) -> None:
        """Lets the light spread.

        Args:
            bent: normals.
            scale: [pixels/m] at the middle of the head.
        """
        told = self.scattering
        self._marks.draw({"uneven": self._uneven.textures[0]})
        self._half.copy(self._lit.textures[0])
        pace = told.width / told.steps
        values: dict[str, Value] = {"pace": pace, "width": told.width}
        across, up = (pace * scale * side for side in self._pixel)
        for each, axis, diffuse in ((self._across, (across, 0.0), self._lit), (self._up, (0.0, up), self._half)):
            inputs = {"position": self._position, "bent": bent, "diffuse": diffuse.textures[0]}
            each.draw(inputs, values | {"axis": axis}, {"steps": told.steps})

    def marked(self) -> float:
        """Share of the picture that was filtered last."""
        return self._marks.share()
