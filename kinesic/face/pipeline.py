"""The deferred pipeline: the head's G-buffer, and the passes that make a picture of it."""

import math
from collections.abc import Mapping

import moderngl
import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.camera import Camera
from kinesic.face.chart import mouth, places, window
from kinesic.face.lights import Lights
from kinesic.face.mesh import PARTS, Mesh
from kinesic.face.occlusion import OcclusionPass
from kinesic.face.paint import Complexion, iris, skin
from kinesic.face.passes import ScreenPass, Size, Target, Value, program, tell, texture
from kinesic.face.presets import Preset
from kinesic.face.shadow import ShadowMap, lamp_view
from kinesic.face.units import deformed, intensities
from kinesic.face.wrinkles import maps, shares

BUMP = 0.022  # height of a wrinkle of depth 1, in distances between the eyes
BACKDROP = (0.055, 0.075, 0.105)  # linear
SCATTER_STEPS = 4  # on each side, as the shader has it
VOLUME = 0.0035  # [m] that hair stands off the scalp

Pixels = NDArray[np.uint8]  # (height, width, 3) sRGB, first row on top


class Geometry:
    """Draws a head into the G-buffer."""

    def __init__(self, context: moderngl.Context, mesh: Mesh, drawn_on: Mesh, size: Size) -> None:
        self.context, self.mesh, self.size = context, mesh, size
        self.depth = context.depth_renderbuffer(size)
        self.target = Target(context, size, ("4f4", "4f4", "4f4"), self.depth)  # position and part, normal, place
        shader = program(context, "geometry", "geometry")
        self._shader = shader
        where = places(drawn_on)
        self._hair = VOLUME * np.clip(where[:, 3] / 0.35, 0.0, 1.0) * (mesh.parts == PARTS.index("skin"))
        fixed = np.column_stack([where, mesh.parts, mesh.tips + mouth(drawn_on)])
        self.moving = context.buffer(reserve=len(where) * 6 * 4, dynamic=True)
        lashes = np.isin(mesh.triangles[:, 0], mesh.vertices("lashes"))
        buffers = [
            (self.moving, "3f 3f", "position", "normal"),
            (context.buffer(fixed.astype("f4").tobytes()), "4f 2f", "place", "matter"),
        ]
        solid, thin = (context.buffer(mesh.triangles[chosen].astype("i4").tobytes()) for chosen in (~lashes, lashes))
        self.solid = solid
        self._solid = context.vertex_array(shader, buffers, solid)
        self._thin = context.vertex_array(shader, buffers, thin)

    def draw(self, units: Mapping[str, float], camera: Camera) -> Target:
        """Position [m] in the camera's frame and part + 1; normal and detail; place in the chart."""
        self.moving.write(self._vertices(units).astype("f4").tobytes())
        tell(self._shader, {"view": camera.view().T, "projection": camera.projection(self.size[0] / self.size[1]).T})
        self.target.frame.use()
        self.target.frame.depth_mask = True
        self.target.frame.clear()
        self.context.depth_func = "<"
        self.context.enable(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._solid.render()
        self.context.disable(moderngl.CULL_FACE)
        self._thin.render()
        return self.target

    def _vertices(self, units: Mapping[str, float]) -> Floats:
        """(v, 6) positions and normals."""
        positions = deformed(self.mesh, units)
        normals = self.mesh.normals(positions)
        eyes = self.mesh.vertices("eyes")
        spokes = positions[eyes] - self.mesh.eyes[np.where(self.mesh.positions[eyes, 1] > 0.0, 0, 1)]
        normals[eyes] = spokes / np.linalg.norm(spokes, axis=1, keepdims=True)
        return np.concatenate([positions + normals * self._hair[:, None], normals], axis=1)


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
        self.geometry = geometry = Geometry(context, mesh, drawn_on, drawn)
        self._preset, self._drawn, self._lights, self._complexion = preset, drawn, lights, complexion
        self._unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])

        def over_head(fragment: str, *formats: str) -> ScreenPass:
            return ScreenPass(context, fragment, Target(context, drawn, formats, geometry.depth))

        def over_all(fragment: str, target: Size) -> ScreenPass:
            return ScreenPass(context, fragment, Target(context, target, ("4f1",), None), everywhere=True)

        self._shadow = ShadowMap(context, geometry.moving, geometry.solid) if preset.shadow else None
        self._relief = over_head("relief", "1f4")
        self._surface = over_head("surface", "4f4", "4f1")
        self._occlusion = preset.occlusion and OcclusionPass(context, drawn, preset.occlusion)
        self._open = texture(context, np.ones((1, 1, 1)))
        self._scatter = [over_head("scatter", "4f4") for _ in range(2)] if preset.scattering else []
        lit = Target(context, drawn, ("4f4",), geometry.depth)
        self._light = ScreenPass(context, "light", lit, defines={"SHADOW": int(preset.shadow)})
        self._compose = over_all("compose", drawn)
        self._smooth = over_all("smooth", drawn)
        self._shrink = over_all("shrink", size)
        packed = np.moveaxis(maps(), 0, -1)
        self._maps = {f"maps{k}": texture(context, packed[..., 4 * k : 4 * k + 4]) for k in range(3)}
        self._painted = {"skin": texture(context, skin(complexion)), "iris": texture(context, iris(complexion))}

    def bend(self, buffer: Target, shown: Floats) -> Target:
        """What the surface is: unit normals bent by wrinkles and depth in a furrow; colour and shine.

        Args:
            buffer: the G-buffer.
            shown: (2, 12) how much of each wrinkle map, on the left and on the right half of the face.
        """
        position, normal, place = buffer.textures
        halves = {
            f"{side}{k}": row[4 * k : 4 * k + 4]
            for side, row in zip(("left", "right"), shown, strict=True)
            for k in range(3)
        }
        inputs = {"position": position, "place": place} | self._maps
        drawn = shown.any()  # most of the time nothing is, in a face that talks
        relief = self._relief.draw(inputs, halves | {"chart": window()}) if drawn else self._relief.clear()
        return self._surface.draw(
            {"position": position, "normal": normal, "place": place, "relief": relief.textures[0]} | self._painted,
            {"chart": window(), "bump": BUMP * self._unit, "hair": self._complexion.hair},
        )

    def draw(self, units: Mapping[str, float], camera: Camera, gain: float) -> Pixels:
        """The picture."""
        shown = shares(intensities(units)) * gain * self._preset.wrinkles
        buffer = self.geometry.draw(units, camera)
        bent, colour = self.bend(buffer, shown).textures
        position, normal, _ = buffer.textures
        scale = self._drawn[1] / (2 * camera.distance * math.tan(math.radians(camera.field_deg) / 2))  # [pixels/m]
        around = self._occlusion.draw(position, normal, scale).textures[0] if self._occlusion else self._open
        lights = self._lights
        values: dict[str, Value] = {"towards": lights.directions(), "power": lights.powers(), "size": self._drawn}
        inputs = {"position": position, "bent": bent, "colour": colour, "open": around}
        if self._shadow:
            lamp = lamp_view(lights.directions()[0], camera.distance)
            inputs["shade"] = self._shadow.draw(lamp @ camera.view())
            values["lamp"] = lamp.T
        values |= {"sky": lights.sky, "ground": lights.ground}
        lit = self._light.draw(inputs, values)
        diffuse = self._scattered(position, bent, lit.textures[0], around, scale)
        picture = self._compose.draw(
            {"position": position, "diffuse": diffuse, "colour": colour},
            {"size": self._drawn, "backdrop": BACKDROP},
        )
        if self._preset.smooth:
            picture.textures[0].filter = (moderngl.LINEAR, moderngl.LINEAR)
            picture = self._smooth.draw({"picture": picture.textures[0]}, {"size": self._drawn})
        if self._preset.samples > 1:
            picture = self._shrink.draw({"picture": picture.textures[0]}, {"samples": self._preset.samples})
        return picture.pixels()

    def _scattered(
        self,
        position: moderngl.Texture,
        bent: moderngl.Texture,
        diffuse: moderngl.Texture,
        around: moderngl.Texture,
        scale: float,
    ) -> moderngl.Texture:
        """Diffuse light after it has spread under the skin."""
        told = self._preset.scattering
        if told is None or self._occlusion is None:
            return diffuse
        pace = told.width / SCATTER_STEPS
        for each, axis in zip(self._scatter, ((1.0, 0.0), (0.0, 1.0)), strict=True):
            inputs = {"position": position, "bent": bent, "diffuse": diffuse, "open": around}
            values: dict[str, Value] = {
                "pace": pace,
                "width": told.width,
                "threshold": told.threshold,
                "size": self._drawn,
            }
            diffuse = each.draw(inputs, values | {"axis": (axis[0] * pace * scale, axis[1] * pace * scale)}).textures[0]
        return diffuse
