"""Lashes: too fine for a G-buffer that has one surface in a pixel, they are laid over the lit picture."""

import moderngl

from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import Target, program, set_uniforms

OVER = (moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA, moderngl.ZERO, moderngl.ONE_MINUS_SRC_ALPHA)


class LashPass:
    """Draws the lashes over a picture of the head, as dense as they are in each pixel."""

    def __init__(self, context: moderngl.Context, geometry: Geometry, picture: moderngl.Texture) -> None:
        """Compiles the shader.

        Args:
            context: to draw in.
            geometry: whose lashes they are, and whose depth tells what they stand before.
            picture: that they are drawn over; its last component is brightness.
        """
        self._context, self._geometry = context, geometry
        self._target = Target.of(context, [picture], geometry.depth)
        self._target.frame.depth_mask = False
        self._shader = program(context, "geometry", "compose", "lashes")
        self._lashes = geometry.drawn(self._shader, "lashes")

    def draw(self, camera: Camera) -> None:
        """Draws them where the head was drawn last."""
        width, height = self._geometry.size
        values = {"view": camera.view().T, "projection": camera.projection(width / height).T}
        set_uniforms(self._shader, values)
        self._target.frame.use()
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.depth_func = "<"
        self._context.blend_func = OVER  # type: ignore[assignment] # moderngl takes four, too
        self._lashes.render()
