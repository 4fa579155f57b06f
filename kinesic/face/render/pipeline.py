"""Deferred pipeline that makes a picture from the head's G-buffer."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.face.assets.action_units import read_intensities
from kinesic.face.assets.chart import compute_chart_window
from kinesic.face.assets.hair import Locks
from kinesic.face.assets.mesh import Mesh
from kinesic.face.assets.paint import Complexion, paint_iris, paint_skin
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Size, Texture
from kinesic.face.render.camera import Camera, Lights
from kinesic.face.render.geometry import Geometry, PositionPass
from kinesic.face.render.lashes import LashPass
from kinesic.face.render.occlusion import OcclusionPass
from kinesic.face.render.passes import (
    ScreenPass,
    StoredPixels,
    Target,
    TextureFormat,
    Value,
    Values,
    make_texture,
    store_pixels,
)
from kinesic.face.render.post import PostProcessing, ScatterPass
from kinesic.face.render.presets import Preset
from kinesic.face.render.shadow import ShadowPass
from kinesic.face.render.shape import MovingMesh
from kinesic.face.render.wrinkles import WrinklePass, compute_map_strengths

SKIN_FORMAT: TextureFormat = "f2"  # half floats, since drivers round differently when they filter bytes
BACKDROP_COLOUR = (0.055, 0.075, 0.105)  # linear RGB colour of the backdrop


@dataclass(frozen=True, eq=False)
class DrawnHead:
    """Head or figure to draw, with its painted mesh, complexion and hair."""

    shape: MovingMesh
    drawn_on: Mesh  # mesh whose chart is used for painting and wrinkles; vertices correspond
    complexion: Complexion
    locks: Locks | None = None  # locks of hair, fixed in the head's frame


class Pipeline:
    """Renderer of a head or figure in one OpenGL context."""

    def __init__(self, context: GlContext, head: DrawnHead, *, preset: Preset, size: Size, lights: Lights) -> None:
        mesh, complexion = head.shape.mesh, head.complexion
        drawn = (size[0] * preset.samples, size[1] * preset.samples)
        self._preset, self._drawn, self._complexion = preset, drawn, complexion
        eyes = make_texture(context, paint_iris(complexion))
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
        self.light(lights)
        self._unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
        balls = mesh.vertices("eyes")
        self._eyeball = float(np.median(np.linalg.norm(mesh.positions[balls, None] - mesh.eyes, axis=2).min(axis=1)))
        painted = _paint_skin_levels(complexion)
        self._skin = make_texture(context, painted[0], SKIN_FORMAT)
        self._skin.write_smaller([level.tobytes() for level in painted[1:]])
        self._skin.filter = (gl.GL_LINEAR_MIPMAP_NEAREST, gl.GL_LINEAR)
        self._white = make_texture(context, np.ones((1, 1, 4)))
        self.relief = WrinklePass(context, geometry, wrinkled=preset.wrinkles)
        self.seen = PositionPass(context, geometry, preset.coarse)
        seen = self.seen.seen
        self.occlusion = OcclusionPass(context, seen, preset.occlusion) if preset.occlusion else None
        self.shadow = ShadowPass(context, geometry, seen, preset.shadow) if preset.shadow else None
        scatter_formats = ("4f4", "4f1") if preset.scattering else ()
        shown = "4f4" if preset.focus else "4f1"  # depth of field interpolates, which needs floats
        lit = Target(context, drawn, (shown, *scatter_formats), geometry.depth)
        levels = preset.scattering.levels if preset.scattering else 1
        defines = {"KEPT": len(scatter_formats), "LEVELS": levels}
        self._light = ScreenPass(context, lit, "form", "surface", "compose", "light", defines=defines)
        self.scatter = ScatterPass(context, geometry, lit, preset.scattering) if preset.scattering else None
        self._lashes = LashPass(context, geometry, lit.textures[0])
        self._backdrop = Target(context, drawn, ("4f1",), None)
        ScreenPass(context, self._backdrop, "compose", "backdrop", where="everywhere").draw(
            {}, {"backdrop": BACKDROP_COLOUR}
        )
        self._finish = PostProcessing(context, geometry, preset, size)

    def light(self, lights: Lights) -> None:
        """Replace the lamps and ambient light for the next pictures."""
        self._lights = lights
        self.geometry.light(lights.directions()[0])

    def widen_pupils(self, diameter: float) -> None:
        """Set the pupil diameter [m] for the next pictures."""
        self.geometry.pupil = 0.5 * diameter / self._eyeball

    def draw(self, units: Mapping[str, float], camera: Camera, gain: float) -> Picture:
        """Draw the face picture and read the pixels from the graphics card."""
        return self.draw_target(units, camera, gain).pixels()

    def draw_target(self, units: Mapping[str, float], camera: Camera, gain: float) -> Target:
        """Draw the face picture and leave it on the graphics card."""
        *_, (_, picture) = self.stages(units, camera, gain)
        return picture

    def stages(self, units: Mapping[str, float], camera: Camera, gain: float) -> Iterator[tuple[str, Target]]:
        """Draw the face picture stage by stage.

        Yields:
            The name of each completed stage, and the target with the picture.
        """
        geometry, picture = self.geometry, self._light.target
        geometry.move(units, camera)
        yield "mesh", picture
        place = geometry.render(camera).textures[1]
        yield "geometry", picture
        relief, bent = self.relief.draw(compute_map_strengths(read_intensities(units)) * gain * self._preset.wrinkles)
        yield "wrinkles", picture
        if self.occlusion or self.shadow:
            self.seen.draw()
            yield "positions", picture
        around = self.draw_openness(camera)
        if self.occlusion:
            yield "occlusion", picture
        reach = self.draw_received_light(camera, around)
        if self.shadow:
            yield "shadow", picture
        inputs = {"place": place, "bent": bent, "relief": relief, "skin": self._skin, "reach": reach}
        picture.copy(self._backdrop)
        if self.scatter:
            self.scatter.clear()
        scale = compute_pixel_scale(camera, self._drawn[1])
        self._light.draw(inputs, self._make_light_uniforms(scale))
        yield "light", picture
        if self.scatter:
            self.scatter.draw(bent, scale)
            yield "scattering", picture
        self._lashes.draw(camera)
        yield "lashes", picture
        yield from self._finish.stages(picture, camera)

    def draw_openness(self, camera: Camera) -> Texture:
        """Draw the received fraction 0..1 of ambient light at each pixel.

        It is 1 everywhere if the preset has no occlusion.
        """
        if self.occlusion is None:
            return self._white
        return self.occlusion.draw(compute_pixel_scale(camera, self._drawn[1]) / self._preset.coarse).textures[0]

    def draw_received_light(self, camera: Camera, around: Texture) -> Texture:
        """Draw the received fractions of key light (per colour) and ambient light.

        All values are in 0..1.
        """
        if self.shadow:
            return self.shadow.draw(self._lights.directions()[0], camera, around).textures[0]
        around.filter = (gl.GL_LINEAR, gl.GL_LINEAR)
        around.swizzle("111R")
        return around

    def _make_light_uniforms(self, scale: float) -> Values:
        """Return the shader uniforms of the light pass."""
        values: dict[str, Value] = {
            "chart": compute_chart_window(),
            "hair": self._complexion.hair,
            "level": self._choose_level(scale),
            "towards": self._lights.directions(),
            "power": self._lights.powers(),
            "sky": self._lights.sky,
            "ground": self._lights.ground,
            "lens": self.geometry.lens,
        }
        if self.scatter:
            values |= self.scatter.light_uniforms
        return values

    def _choose_level(self, scale: float) -> float:
        """Return the skin texture's mipmap level that matches screen pixels."""
        ours = self._skin.height * compute_chart_window()[1]
        return float(max(round(math.log2(ours / (scale * self._unit))), 0))


@cache
def _paint_skin_levels(complexion: Complexion) -> tuple[StoredPixels, ...]:
    """Return the (n, n, 4) skin texture and its mipmap levels.

    Components are square roots of the colours, and dryness.
    """
    levels = [paint_skin(complexion) ** (0.5, 0.5, 0.5, 1.0)]
    while len(levels[-1]) > 1:
        half = len(levels[-1]) // 2
        levels.append(levels[-1].reshape(half, 2, half, 2, 4).mean(axis=(1, 3)))
    return tuple(store_pixels(level, SKIN_FORMAT) for level in levels)


def compute_pixel_scale(camera: Camera, height: int) -> float:
    """Return the picture scale [pixels/m] at the head's centre."""
    return height / (2 * camera.distance * math.tan(math.radians(camera.field_deg) / 2))
