"""Light that spreads under the skin (thesis 5.1), where occlusion says that the surface curves (5.2).

Wrinkles and the edges of shadows are too fine for occlusion to tell; what they make uneven is filtered, too.
"""

import moderngl

from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import Marks, ScreenPass, Target, Value
from kinesic.face.render.presets import Scattering


class ScatterPass:
    """Filters diffuse light along one axis and then along the other, and mends the picture where it did."""

    def __init__(self, context: moderngl.Context, geometry: Geometry, lit: Target, scattering: Scattering) -> None:
        self.scattering, self._geometry = scattering, geometry
        self._pixel = [1.0 / side for side in geometry.size]
        self._marks = Marks(context, ("mark_skin",), geometry.size)
        picture, diffuse, colour = lit.textures
        self._diffuse, self._colour = (Target.of(context, [each], None) for each in (diffuse, colour))
        half = Target(context, geometry.size, ("4f4",), self._marks.depth)
        mended = Target.of(context, [picture], self._marks.depth)
        self._across, self._up = (
            ScreenPass(context, onto, *fragments, where="marked", defines={"STEPS": scattering.steps, "LAST": last})
            for fragments, onto, last in ((("scatter",), half, 0), (("compose", "scatter"), mended, 1))
        )

    def clear(self) -> None:
        """Marks nothing as uneven, before light is drawn."""
        self._colour.frame.clear()

    def draw(self, bent: moderngl.Texture, scale: float) -> None:
        """Lets the light spread.

        Args:
            bent: normals, with depth and part.
            scale: [pixels/m] at the middle of the head.
        """
        scattering = self.scattering
        colour = self._colour.textures[0]
        self._marks.draw({"colour": colour}, within=self._geometry.covered)
        values: dict[str, Value] = {"width": scattering.width}
        across, up = (scattering.width / scattering.steps * scale * side for side in self._pixel)
        half = self._across.target
        half.copy(self._diffuse)
        self._across.draw({"bent": bent, "diffuse": self._diffuse.textures[0]}, values | {"axis": (across, 0.0)})
        inputs = {"bent": bent, "diffuse": half.textures[0], "colour": colour}
        self._up.draw(inputs, values | {"axis": (0.0, up)})

    def marked(self) -> float:
        """Tells which share of the picture was filtered last."""
        return self._marks.share()
