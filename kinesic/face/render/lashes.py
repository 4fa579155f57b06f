"""Lashes: too fine for a G-buffer that has one surface in a pixel, they are laid over the lit picture."""

from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import Target, program, set_uniforms

OVER = (gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA), (gl.ZERO, gl.ONE_MINUS_SRC_ALPHA)  # of colours, of brightness


class LashPass:
    """Draws the lashes over a picture of the head, as dense as they are in each pixel."""

    def __init__(self, context: GlContext, geometry: Geometry, picture: Texture) -> None:
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
        self._context.switch_on(gl.DEPTH_TEST, gl.BLEND)
        self._context.compare_depth("<")
        self._context.blend(*OVER)
        self._lashes.render()
