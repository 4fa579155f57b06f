"""Soft shadow of the key light by shadow mapping (L. Williams, 1978).

The depth map of the lamp is compared softly (thesis 12.1). Translucent layers have a separate map with colours. They
are drawn into it with a screen-door mask, so that some pixels hold the colour and the others let all light pass; their
mean is the transmitted light.
"""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.programs import Vertices
from kinesic.face.gl.textures import Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import Geometry, PositionBuffer
from kinesic.face.render.passes import ScreenPass, Target, Value, compile_program, set_uniforms
from kinesic.face.render.presets import Shadow

SHADOW_FORMAT = "4f4"  # full floats: drivers interpolate bytes differently, half floats are slower


class ShadowPass:
    """Pass that computes the fraction of key light at each head pixel."""

    def __init__(self, context: GlContext, geometry: Geometry, seen: PositionBuffer, shadow: Shadow) -> None:
        self.shadow, self._seen = shadow, seen
        reached = Target(context, seen.position.size, (SHADOW_FORMAT,), seen.depth)
        reached.textures[0].filter = (gl.GL_LINEAR, gl.GL_LINEAR)
        defines = {"COLOURED": int(shadow.coloured), "BLOCKERS": shadow.blockers, "TAPS": shadow.taps}
        defines["BILINEAR"] = int(shadow.bilinear)
        self._shade = ScreenPass(context, reached, "shade", where=seen.where, defines=defines)
        solid = compile_program(context, "geometry", "shadow")
        layers = [geometry.make_layer(solid, "skin")]
        if geometry.dressed:
            layers.append(geometry.make_layer(compile_program(context, "geometry", "cut"), "cloth"))
        if geometry.haired:
            layers.append(geometry.make_layer(solid, "hair"))
        self._solid = _ShadowMap(context, shadow.side, [], layers)
        self._thin: _ShadowMap | None = None
        if shadow.coloured:
            self._tints = Target(context, (shadow.side, shadow.side), ("4f1",), None).textures
            tinted = compile_program(context, "geometry", "form", "door", "tint")
            self._thin = _ShadowMap(
                context, shadow.side, self._tints, [geometry.make_layer(tinted, layer) for layer in geometry.thin]
            )

    def draw(self, towards: Floats, camera: Camera, around: Texture) -> Target:
        """Draw received fractions 0..1 of key light (per colour) and ambient light.

        Args:
            towards: (3,) unit vector to the lamp in the camera's frame.
            camera: camera of the G-buffer.
            around: openness of each pixel to ambient light, in the first component.
        """
        shadow, seen = self.shadow, self._seen
        lamp, view = compute_lamp_view(towards, camera.distance, shadow), camera.view()
        inputs = {"position": seen.position, "normal": seen.normal, "open": around}
        inputs["depths"] = self._solid.draw(view, lamp)
        if self._thin is not None:
            inputs |= {"tint_depths": self._thin.draw(view, lamp), "tints": self._tints[0]}
        values: dict[str, Value] = {
            "lamp": lamp.T,
            "deep": shadow.deep,
            "away": shadow.away,
            "wide": shadow.lamp / (2 * shadow.reach),
            "nearest": shadow.sharpest / (2 * shadow.reach),
        }
        self._shade.clear(1.0, 1.0, 1.0, 1.0)
        return self._shade.draw(inputs, values)


class _ShadowMap:
    """Depth map of mesh layers as seen from a distant lamp."""

    def __init__(
        self,
        context: GlContext,
        side: int,
        colours: Sequence[Texture],
        layers: Sequence[Vertices],
    ) -> None:
        self._context, self._layers = context, layers
        self._culling = () if colours else (gl.GL_CULL_FACE,)  # translucent layers are double-sided
        self._depths = context.depth_texture((side, side))
        self._depths.clamp()
        self._frame = context.frame(colours, self._depths)

    def draw(self, view: Floats, lamp: Floats) -> Texture:
        """Draw the depths 0..1 as seen from the lamp."""
        for layer in self._layers:
            set_uniforms(layer.program, {"view": view.T, "projection": lamp.T})
        self._frame.use()
        self._frame.clear()
        self._context.switch_on(gl.GL_DEPTH_TEST, *self._culling)
        self._context.compare_depth("<")
        for layer in self._layers:
            layer.render()
        return self._depths


def compute_lamp_view(towards: Floats, distance: float, shadow: Shadow) -> Floats:
    """Return the (4, 4) transform from camera frame to lamp clip space.

    Args:
        towards: (3,) unit vector to the lamp in the camera's frame.
        distance: [m] from the camera to the centre of the head.
        shadow: extent of the shadow map.
    """
    right = np.cross((0.0, 1.0, 0.0), towards)
    right /= np.linalg.norm(right)
    rotation = np.array([right, np.cross(towards, right), towards]) / np.array(
        [[shadow.reach], [shadow.reach], [-shadow.deep]]
    )
    transform = np.eye(4)
    transform[:3, :3] = rotation
    transform[:3, 3] = rotation @ (0.0, 0.0, distance)
    return transform
