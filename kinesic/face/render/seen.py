"""Where each pixel of the head is and where it faces, unpacked for passes that need no more."""

from dataclasses import dataclass

import moderngl

from kinesic.face.render.geometry import Geometry
from kinesic.face.render.passes import Marks, Where


@dataclass(frozen=True, eq=False)
class PositionBuffer:
    """Textures as large as each other."""

    position: moderngl.Texture  # [m] in the camera's frame; part + 1, 0 on the background
    normal: moderngl.Texture
    depth: moderngl.Renderbuffer | None = None
    where: Where = "everywhere"


class SeenPass:
    """Unpacks the G-buffer, in whole or with fewer pixels."""

    def __init__(self, context: moderngl.Context, geometry: Geometry, pixels: int = 1) -> None:
        """Makes the textures.

        Args:
            context: to draw in.
            geometry: whose G-buffer it is.
            pixels: of it along a side of one of these.
        """
        width, height = (-(-side // pixels) for side in geometry.size)
        self._geometry = geometry
        self._marks = Marks(context, ("form", "unpack"), (width, height), ("4f4", "4f4"))
        self.target = self._marks.target
        position, normal = self.target.textures
        self.seen = PositionBuffer(position, normal, self._marks.depth, "marked")
        sides = zip(geometry.size, (width, height), strict=True)
        self._offset = [(pixels // 2 + 0.5) / whole - 0.5 / own for whole, own in sides]

    def draw(self) -> PositionBuffer:
        """What was drawn last."""
        form, _ = self._geometry.target.textures
        self._marks.draw({"form": form}, {"offset": self._offset, "lens": self._geometry.lens})
        return self.seen
