"""The shadow of the key light: the head's depth as the lamp sees it (L. Williams, 1978; thesis 12.1)."""

import moderngl
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.passes import program, tell

SIDE = 512  # pixels of the map
REACH = 0.22  # [m] that it covers round the middle of the head, across
DEEP = 0.35  # [m] and along the light
STRIDE_BYTES = 12  # of the normals between positions


class ShadowMap:
    """A depth texture that is drawn again when the head moves."""

    def __init__(self, context: moderngl.Context, moving: moderngl.Buffer, indices: moderngl.Buffer) -> None:
        self._context = context
        self.texture = context.depth_texture((SIDE, SIDE))
        self.texture.compare_func = "<="
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._frame = context.framebuffer(depth_attachment=self.texture)
        self._shader = program(context, "shadow", "shadow")
        layout = [(moving, f"3f {STRIDE_BYTES}x", "position")]
        self._mesh = context.vertex_array(self._shader, layout, indices)

    def draw(self, lamp: Floats) -> moderngl.Texture:
        """Depths from a lamp, 0..1, for comparison.

        Args:
            lamp: (4, 4) from the head's frame to the lamp's clip space.
        """
        tell(self._shader, {"lamp": lamp.T})
        self._frame.use()
        self._frame.clear()
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.depth_func = "<"
        self._mesh.render()
        return self.texture


def lamp_view(towards: Floats, distance: float) -> Floats:
    """(4, 4) from the camera's frame to the clip space of a far lamp.

    Args:
        towards: (3,) unit vector to the lamp in the camera's frame.
        distance: [m] from the camera to the middle of the head.
    """
    right = np.cross((0.0, 1.0, 0.0), towards)
    right /= np.linalg.norm(right)
    rotation = np.array([right, np.cross(towards, right), towards]) / np.array([[REACH], [REACH], [-DEEP]])
    found = np.eye(4)
    found[:3, :3] = rotation
    found[:3, 3] = rotation @ (0.0, 0.0, distance)
    return found
