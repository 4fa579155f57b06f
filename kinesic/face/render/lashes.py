"""Eyelashes, blended over the lit picture.

They are too fine for a G-buffer with one surface per pixel.
"""

from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import Target, compile_program, set_uniforms

# OpenGL blend factors of source and target: for the colour components, then for the fourth component, brightness.
ALPHA_BLENDING = (gl.GL_SRC_ALPHA, gl.GL_ONE_MINUS_SRC_ALPHA), (gl.GL_ZERO, gl.GL_ONE_MINUS_SRC_ALPHA)


class LashPass:
    """Pass that blends the lashes over a picture by their density."""

    def __init__(self, context: GlContext, geometry: Geometry, picture: Texture) -> None:
        """Compile the shader of the lashes.

        Args:
            context: OpenGL context.
            geometry: head with the lashes, and its depth.
            picture: target picture; its last component is brightness.
        """
        self._context, self._geometry = context, geometry
        self._target = Target.of(context, [picture], geometry.depth)
        self._target.frame.depth_mask = False
        self._shader = compile_program(context, "geometry", "compose", "lashes")
        self._lashes = geometry.make_layer(self._shader, "lashes")

    def draw(self, camera: Camera) -> None:
        """Draw the lashes over the last drawn head."""
        width, height = self._geometry.size
        values = {"view": camera.view().T, "projection": camera.projection(width / height).T}
        set_uniforms(self._shader, values)
        self._target.frame.use()
        self._context.switch_on(gl.GL_DEPTH_TEST, gl.GL_BLEND)
        self._context.compare_depth("<")
        self._context.blend(*ALPHA_BLENDING)
        self._lashes.render()
