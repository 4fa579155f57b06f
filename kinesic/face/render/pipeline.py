"""The deferred pipeline: the passes that make a picture of the head's G-buffer."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.face.assets.action_units import intensities
from kinesic.face.assets.chart import chart_window
from kinesic.face.assets.hair import Locks
from kinesic.face.assets.mesh import Mesh
from kinesic.face.assets.paint import Complexion, iris, skin
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Size, Texture
from kinesic.face.render.camera import Camera, Lights
from kinesic.face.render.geometry import Geometry, PositionPass
from kinesic.face.render.lashes import LashPass
from kinesic.face.render.occlusion import OcclusionPass
from kinesic.face.render.passes import ScreenPass, Stored, Target, TextureFormat, Value, Values, store_pixels, texture
from kinesic.face.render.post import PostProcessing, ScatterPass
from kinesic.face.render.presets import Preset
from kinesic.face.render.shadow import ShadowPass
from kinesic.face.render.shape import MovingMesh
from kinesic.face.render.wrinkles import WrinklePass, shares

PAINT: TextureFormat = "f2"  # of the painting: filtering bytes, drivers round to either side
BACKDROP = (0.055, 0.075, 0.105)  # linear


@dataclass(frozen=True, eq=False)
class DrawnHead:
    """What is drawn: a head or a figure, the mesh that it is painted on, and its complexion."""

    shape: MovingMesh
    drawn_on: Mesh  # in whose chart the painting and the wrinkles are drawn; the vertices correspond
    complexion: Complexion
    locks: Locks | None = None  # that stand still in the head's frame


class Pipeline:
    """Draws a head that shows action units, in one OpenGL context."""

    def __init__(self, context: GlContext, head: DrawnHead, *, preset: Preset, size: Size, lights: Lights) -> None:
        mesh, complexion = head.shape.mesh, head.complexion
        drawn = (size[0] * preset.samples, size[1] * preset.samples)
        self._preset, self._drawn, self._lights, self._complexion = preset, drawn, lights, complexion
        eyes = texture(context, iris(complexion))
        self.geometry = geometry = Geometry(
            context,
            head.shape,
            head.drawn_on,
            drawn,
            eyes,
            shaded=preset.eyeshade,
            locks=head.locks,
            hair=complexion.hair,
        )
        self._unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
        balls = mesh.vertices("eyes")
        self._eyeball = float(np.median(np.linalg.norm(mesh.positions[balls, None] - mesh.eyes, axis=2).min(axis=1)))
        painted = _painted(complexion)
        self._skin = texture(context, painted[0], PAINT)
        self._skin.write_smaller([each.tobytes() for each in painted[1:]])
        self._skin.filter = (gl.LINEAR_MIPMAP_NEAREST, gl.LINEAR)
        self._white = texture(context, np.ones((1, 1, 4)))
        self.relief = WrinklePass(context, geometry, wrinkled=preset.wrinkles)
        self.seen = PositionPass(context, geometry, preset.coarse)
        seen = self.seen.seen
        self.occlusion = OcclusionPass(context, seen, preset.occlusion) if preset.occlusion else None
        self.shadow = ShadowPass(context, geometry, seen, preset.shadow) if preset.shadow else None
        kept = ("4f4", "4f1") if preset.scattering else ()
        shown = "4f4" if preset.focus else "4f1"  # what is out of focus is mixed between pixels, and so not of bytes
        lit = Target(context, drawn, (shown, *kept), geometry.depth)
        levels = preset.scattering.levels if preset.scattering else 1
        defines = {"KEPT": len(kept), "LEVELS": levels}
        self._light = ScreenPass(context, lit, "form", "surface", "compose", "light", defines=defines)
        self.scatter = ScatterPass(context, geometry, lit, preset.scattering) if preset.scattering else None
        self._lashes = LashPass(context, geometry, lit.textures[0])
        self._backdrop = Target(context, drawn, ("4f1",), None)
        ScreenPass(context, self._backdrop, "compose", "backdrop", where="everywhere").draw({}, {"backdrop": BACKDROP})
        self._finish = PostProcessing(context, geometry, preset, size)

    def light(self, lights: Lights) -> None:
        """Lights what is drawn next otherwise."""
        self._lights = lights

    def widen_pupils(self, diameter: float) -> None:
        """Has what is drawn next look from pupils of a diameter [m]."""
        self.geometry.pupil = 0.5 * diameter / self._eyeball

    def draw(self, units: Mapping[str, float], camera: Camera, gain: float) -> Picture:
        """Draws the picture and reads it back."""
        return self.drawn(units, camera, gain).pixels()

    def drawn(self, units: Mapping[str, float], camera: Camera, gain: float) -> Target:
        """Draws the picture and leaves it on the graphics card."""
        *_, (_, picture) = self.stages(units, camera, gain)
        return picture

    def stages(self, units: Mapping[str, float], camera: Camera, gain: float) -> Iterator[tuple[str, Target]]:
        """Draws the picture stage by stage: yields the name of each that is drawn, and where the picture is by then."""
        geometry, picture = self.geometry, self._light.target
        geometry.move(units, camera)
        yield "mesh", picture
        place = geometry.render(camera).textures[1]
        yield "geometry", picture
        relief, bent = self.relief.draw(shares(intensities(units)) * gain * self._preset.wrinkles)
        yield "wrinkles", picture
        if self.occlusion or self.shadow:
            self.seen.draw()
            yield "positions", picture
        around = self.around(camera)
        if self.occlusion:
            yield "occlusion", picture
        reach = self.reach(camera, around)
        if self.shadow:
            yield "shadow", picture
        inputs = {"place": place, "bent": bent, "relief": relief, "skin": self._skin, "reach": reach}
        picture.copy(self._backdrop)
        if self.scatter:
            self.scatter.clear()
        scale = pixels_per_metre(camera, self._drawn[1])
        self._light.draw(inputs, self._lit(scale))
        yield "light", picture
        if self.scatter:
            self.scatter.draw(bent, scale)
            yield "scattering", picture
        self._lashes.draw(camera)
        yield "lashes", picture
        yield from self._finish.stages(picture, camera)

    def around(self, camera: Camera) -> Texture:
        """Draws how much of the light around reaches each pixel, in the first component."""
        if self.occlusion is None:
            return self._white
        return self.occlusion.draw(pixels_per_metre(camera, self._drawn[1]) / self._preset.coarse).textures[0]

    def reach(self, camera: Camera, around: Texture) -> Texture:
        """Draws how much of the key's light, 0..1 for each colour, and of the light around reaches each pixel."""
        if self.shadow:
            return self.shadow.draw(self._lights.directions()[0], camera, around).textures[0]
        around.filter = (gl.LINEAR, gl.LINEAR)
        around.swizzle("111R")
        return around

    def _lit(self, scale: float) -> Values:
        """Collects the values that the pass of the light needs."""
        values: dict[str, Value] = {
            "chart": chart_window(),
            "hair": self._complexion.hair,
            "level": self._level(scale),
            "towards": self._lights.directions(),
            "power": self._lights.powers(),
            "sky": self._lights.sky,
            "ground": self._lights.ground,
            "lens": self.geometry.lens,
        }
        if self.scatter:
            values |= self.scatter.asked
        return values

    def _level(self, scale: float) -> float:
        """How often the painting must be halved until its pixels are about as large as those of the screen."""
        ours = self._skin.height * chart_window()[1]
        return float(max(round(math.log2(ours / (scale * self._unit))), 0))


@cache
def _painted(complexion: Complexion) -> tuple[Stored, ...]:
    """(n, n, 4) skin as its texture holds it, and halves of it: square roots of its colours, and how dry it is."""
    levels = [skin(complexion) ** (0.5, 0.5, 0.5, 1.0)]
    while len(levels[-1]) > 1:
        half = len(levels[-1]) // 2
        levels.append(levels[-1].reshape(half, 2, half, 2, 4).mean(axis=(1, 3)))
    return tuple(store_pixels(each, PAINT) for each in levels)


def pixels_per_metre(camera: Camera, height: int) -> float:
    """Gives how large things are at the middle of the head, in a picture of a height [pixels]."""
    return height / (2 * camera.distance * math.tan(math.radians(camera.field_deg) / 2))
