"""The deferred pipeline: the passes that make a picture of the head's G-buffer."""

import math
from collections.abc import Mapping

import moderngl
import numpy as np
from numpy.typing import NDArray

from kinesic.face.camera import Camera
from kinesic.face.chart import window
from kinesic.face.finish import Finish
from kinesic.face.geometry import Coarse, Geometry
from kinesic.face.lights import Lights
from kinesic.face.mesh import Mesh
from kinesic.face.occlusion import OcclusionPass
from kinesic.face.paint import Complexion, iris, skin
from kinesic.face.passes import ScreenPass, Size, Target, Value, texture
from kinesic.face.presets import Preset
from kinesic.face.relief import ReliefPass
from kinesic.face.scattering import ScatterPass
from kinesic.face.shadow import ShadowPass
from kinesic.face.units import intensities
from kinesic.face.wrinkles import shares

BACKDROP = (0.055, 0.075, 0.105)  # linear

Pixels = NDArray[np.uint8]  # (height, width, 3) sRGB, first row on top


class Pipeline:
    """From action units to pixels, in one OpenGL context."""

    def __init__(
        self,
        context: moderngl.Context,
        mesh: Mesh,
        drawn_on: Mesh,
        complexion: Complexion,
        *,
        preset: Preset,
        size: Size,
        lights: Lights,
    ) -> None:
        drawn = (size[0] * preset.samples, size[1] * preset.samples)
        self._preset, self._drawn, self._lights, self._complexion = preset, drawn, lights, complexion
        eyes = texture(context, iris(complexion))
        self.geometry = geometry = Geometry(context, mesh, drawn_on, drawn, eyes, shaded=preset.eyeshade)
        self._unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
        self._skin = texture(context, skin(complexion) ** (0.5, 0.5, 0.5, 1.0), "f1")
        self._skin.build_mipmaps()
        self._skin.filter = (moderngl.LINEAR_MIPMAP_NEAREST, moderngl.LINEAR)
        self._white = texture(context, np.ones((1, 1, 3)))
        self.relief = ReliefPass(context, geometry)
        self._surface = ScreenPass(context, "surface", Target(context, drawn, ("4f1",), geometry.depth))
        shrunk = preset.coarse > 1 and (preset.occlusion or preset.shadow)
        self._coarse = Coarse(context, geometry.target, preset.coarse) if shrunk else None
        seen = self._coarse.seen if self._coarse else geometry.seen
        self.occlusion = OcclusionPass(context, seen, preset.occlusion) if preset.occlusion else None
        self.shadow = ShadowPass(context, geometry, seen, preset.shadow) if preset.shadow else None
        lit = Target(context, drawn, ("4f4", "4f1"), geometry.depth)
        self._light = ScreenPass(context, "light", lit)
        self.scatter = ScatterPass(context, geometry, lit, preset.scattering) if preset.scattering else None
        self._backdrop = Target(context, drawn, ("4f1",), None)
        ScreenPass(context, "backdrop", self._backdrop, where="everywhere").draw({}, {"backdrop": BACKDROP})
        self._compose = ScreenPass(context, "compose", Target(context, drawn, ("4f1",), geometry.depth))
        self._finish = Finish(context, geometry, preset, size)

    def draw(self, units: Mapping[str, float], camera: Camera, gain: float) -> Pixels:
        """The picture."""
        return self.drawn(units, camera, gain).pixels()

    def drawn(self, units: Mapping[str, float], camera: Camera, gain: float) -> Target:
        """The picture where it was drawn."""
        position, _, place = self.geometry.draw(units, camera).textures
        relief, bent = self.relief.draw(shares(intensities(units)) * gain * self._preset.wrinkles)
        scale = pixels_per_metre(camera, self._drawn[1])
        half = math.tan(math.radians(camera.field_deg) / 2)
        colour = self._surface.draw(
            {"position": position, "place": place, "relief": relief, "skin": self._skin},
            {"chart": window(), "hair": self._complexion.hair, "level": self._level(scale)},
        ).textures[0]
        if self._coarse:
            self._coarse.draw()
        around, shade = self.around(camera), self.shade(camera)
        lights: dict[str, Value] = {
            "towards": self._lights.directions(),
            "power": self._lights.powers(),
            "sky": self._lights.sky,
            "ground": self._lights.ground,
            "threshold": self._preset.scattering.threshold if self._preset.scattering else math.inf,
            "lens": (half * self._drawn[0] / self._drawn[1], half),
        }
        shapes = {"bent": bent, "colour": colour, "open": around, "shade": shade, "relief": relief}
        if self.scatter:
            self.scatter.clear()
        lit = self._light.draw(shapes, lights)
        if self.scatter:
            self.scatter.draw(bent, scale)
        self._compose.target.copy(self._backdrop.textures[0])
        picture = self._compose.draw({"diffuse": lit.textures[0], "colour": colour})
        return self._finish.draw(picture, camera)

    def around(self, camera: Camera) -> moderngl.Texture:
        """How open each pixel is to the light around."""
        if self.occlusion is None:
            return self._white
        return self.occlusion.draw(pixels_per_metre(camera, self._drawn[1]) / self._preset.coarse).textures[0]

    def shade(self, camera: Camera) -> moderngl.Texture:
        """How much of the key's light reaches each pixel."""
        return self.shadow.draw(self._lights.directions()[0], camera).textures[0] if self.shadow else self._white

    def _level(self, scale: float) -> float:
        """How often the painting must be halved until its pixels are about as large as those of the screen."""
        ours = self._skin.height * window()[1]
        return float(max(round(math.log2(ours / (scale * self._unit))), 0))


def pixels_per_metre(camera: Camera, height: int) -> float:
    """How large things are at the middle of the head, in a picture of a height [pixels]."""
    return height / (2 * camera.distance * math.tan(math.radians(camera.field_deg) / 2))
