"""The shadow of the key light: the head's depth as the lamp sees it (L. Williams, 1978), compared softly (thesis 12.1).

What light shines through has a map of its own, with colours. It is drawn into it through a screen-door mask, so that a
part of its pixels holds the colour and the others let all light pass; their mean is what arrives.
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
from kinesic.face.render.passes import ScreenPass, Target, Value, program, set_uniforms
from kinesic.face.render.presets import Shadow

REACHED = "4f4"  # between pixels of bytes, drivers round to either side; half floats take longer


class ShadowPass:
    """Finds how much of the key's light reaches each pixel of the head."""

    def __init__(self, context: GlContext, geometry: Geometry, seen: PositionBuffer, shadow: Shadow) -> None:
        self.shadow, self._seen = shadow, seen
        reached = Target(context, seen.position.size, (REACHED,), seen.depth)
        reached.textures[0].filter = (gl.LINEAR, gl.LINEAR)
        defines = {"COLOURED": int(shadow.coloured), "BLOCKERS": shadow.blockers, "TAPS": shadow.taps}
        self._shade = ScreenPass(context, reached, "shade", where=seen.where, defines=defines)
        solid = program(context, "geometry", "shadow")
        layers = [geometry.drawn(solid, "skin")]
        if geometry.dressed:
            layers.append(geometry.drawn(program(context, "geometry", "cut"), "cloth"))
        if geometry.haired:
            layers.append(geometry.drawn(solid, "hair"))
        self._solid = _Map(context, shadow.side, [], layers)
        self._thin: _Map | None = None
        if shadow.coloured:
            self._tints = Target(context, (shadow.side, shadow.side), ("4f1",), None).textures
            tinted = program(context, "geometry", "form", "door", "tint")
            self._thin = _Map(
                context, shadow.side, self._tints, [geometry.drawn(tinted, each) for each in geometry.thin]
            )

    def draw(self, towards: Floats, camera: Camera, around: Texture) -> Target:
        """Draws the key's light at each pixel, 0..1 for each colour, and how open it is to the light around.

        Args:
            towards: (3,) unit vector to the lamp in the camera's frame.
            camera: that the G-buffer was drawn from.
            around: how open each pixel is, in the first component.
        """
        shadow, seen = self.shadow, self._seen
        lamp, view = lamp_view(towards, camera.distance, shadow), camera.view()
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


class _Map:
    """What a far lamp sees of some layers."""

    def __init__(
        self,
        context: GlContext,
        side: int,
        colours: Sequence[Texture],
        layers: Sequence[Vertices],
    ) -> None:
        self._context, self._layers = context, layers
        self._culling = () if colours else (gl.CULL_FACE,)  # films are seen from both sides
        self._depths = context.depth_texture((side, side))
        self._depths.clamp()
        self._frame = context.frame(colours, self._depths)

    def draw(self, view: Floats, lamp: Floats) -> Texture:
        """Depths 0..1."""
        for each in self._layers:
            set_uniforms(each.program, {"view": view.T, "projection": lamp.T})
        self._frame.use()
        self._frame.clear()
        self._context.switch_on(gl.DEPTH_TEST, *self._culling)
        self._context.compare_depth("<")
        for each in self._layers:
            each.render()
        return self._depths


def lamp_view(towards: Floats, distance: float, shadow: Shadow) -> Floats:
    """(4, 4) from the camera's frame to the clip space of a far lamp.

    Args:
        towards: (3,) unit vector to the lamp in the camera's frame.
        distance: [m] from the camera to the middle of the head.
        shadow: how far it reaches.
    """
    right = np.cross((0.0, 1.0, 0.0), towards)
    right /= np.linalg.norm(right)
    rotation = np.array([right, np.cross(towards, right), towards]) / np.array(
        [[shadow.reach], [shadow.reach], [-shadow.deep]]
    )
    found = np.eye(4)
    found[:3, :3] = rotation
    found[:3, 3] = rotation @ (0.0, 0.0, distance)
    return found
