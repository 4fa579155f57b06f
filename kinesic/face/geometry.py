"""The head's G-buffer: what each pixel of it shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import moderngl
import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats
from kinesic.face.camera import Camera
from kinesic.face.chart import places, unrolled
from kinesic.face.eyeshade import eyeshade
from kinesic.face.heads import steadied
from kinesic.face.mesh import PARTS, Mesh
from kinesic.face.passes import Marks, Rectangle, Size, Target, Where, program, tell
from kinesic.face.units import deformed

Layer = Literal["skin", "organs", "lashes", "film"]

VOLUME = 0.0035  # [m] that hair stands off the scalp
MARGIN = 3  # [pixels] round a rectangle
FILM = (0.30, 0.95, 0.45)  # what an eyeshade lets through, linear
COVER = 0.5  # share of its pixels that are drawn
GLOSS = 0.5


@dataclass(frozen=True, eq=False)
class Seen:
    """Where each pixel of the head is and where it faces, for passes that need no more."""

    position: moderngl.Texture
    normal: moderngl.Texture
    depth: moderngl.Renderbuffer | None = None
    where: Where = "everywhere"


class Coarse:
    """A G-buffer of fewer pixels."""

    def __init__(self, context: moderngl.Context, target: Target, pixels: int) -> None:
        """Makes the textures.

        Args:
            context: to draw in.
            target: the whole G-buffer.
            pixels: of it along a side of one of these.
        """
        self._whole, self._pixels = target.textures, pixels
        width, height = (-(-side // pixels) for side in target.textures[0].size)
        self._marks = Marks(context, "shrink_geometry", (width, height), ("4f4", "4f4"))
        position, normal = self._marks.target.textures
        self.seen = Seen(position, normal, self._marks.depth, "marked")

    def draw(self) -> None:
        """Takes its pixels from the whole."""
        sides = zip(self._whole[0].size, self.seen.position.size, strict=True)
        offset = [(self._pixels // 2 + 0.5) / whole - 0.5 / own for whole, own in sides]
        self._marks.draw({"position": self._whole[0], "normal": self._whole[1]}, {"offset": offset})


class Geometry:
    """Draws a head into the G-buffer, and lets others draw it elsewhere."""

    def __init__(
        self,
        context: moderngl.Context,
        mesh: Mesh,
        drawn_on: Mesh,
        size: Size,
        iris: moderngl.Texture,
        *,
        shaded: bool = False,
    ) -> None:
        """Uploads what does not move.

        Args:
            context: to draw in.
            mesh: of the head.
            drawn_on: the same faces at the places of the head whose chart everything is painted in.
            size: of the G-buffer.
            iris: how an eye is painted.
            shaded: whether the head wears an eyeshade.
        """
        self.context, self.mesh, self.size = context, mesh, size
        self.depth = context.depth_renderbuffer(size)
        self.target = Target(context, size, ("4f4", "4f4", "4f4"), self.depth)  # position and part, normal, place
        self.target.frame.depth_mask = True
        position, normal, _ = self.target.textures
        self.seen = Seen(position, normal, self.depth, "head")
        self._emptied = context.framebuffer([position], self.depth)  # what is not on the head is read nowhere else
        self._iris = iris
        self.place = places(drawn_on)
        skin = mesh.parts == PARTS.index("skin")
        self._hair = VOLUME * np.clip(self.place[:, 3] / 0.35, 0.0, 1.0) * skin
        self._sources, on_chart, triangles = unrolled(self.place, mesh.triangles)
        fixed = np.column_stack([on_chart, mesh.parts[self._sources], mesh.tips[self._sources]])
        self._moving = context.buffer(reserve=len(fixed) * 6 * 4, dynamic=True)
        first = mesh.triangles[:, 0]
        thin = mesh.parts[first] == PARTS.index("lashes")
        still = self._buffer(fixed)
        self._layers = {
            "skin": (self._moving, still, self._buffer(triangles[skin[first]], "i4")),
            "organs": (self._moving, still, self._buffer(triangles[~skin[first] & ~thin], "i4")),
            "lashes": (self._moving, still, self._buffer(triangles[thin], "i4")),
        }
        if shaded:
            self._layers["film"] = self._film(mesh)
        skins, organs = (program(context, "geometry", fragment) for fragment in ("skin", "organs"))
        film = program(context, "geometry", "door", "film")
        self._shaders = (skins, organs, film)
        self._solid = (self.drawn(skins, "skin"), self.drawn(organs, "organs"))
        self.thin: tuple[Layer, ...] = ("lashes", "film") if shaded else ("lashes",)
        self._open = [self.drawn(film if each == "film" else organs, each) for each in self.thin]

    def drawn(self, shader: moderngl.Program, layer: Layer) -> moderngl.VertexArray:
        """One of the layers, for a program with the vertex shader `geometry`."""
        moving, still, indices = self._layers[layer]
        buffers = [(moving, "3f 3f", "position", "normal") if "normal" in shader else (moving, "3f 12x", "position")]
        if "place" in shader:  # a compiler drops what nothing reads
            buffers.append((still, "4f 2f", "place", "matter") if "matter" in shader else (still, "4f 8x", "place"))
        return self.context.vertex_array(shader, buffers, indices)

    def draw(self, units: Mapping[str, float], camera: Camera) -> Target:
        """Position [m] in the camera's frame and part + 1; normal and detail; place in the chart, or colour."""
        vertices = self._vertices(units, camera)
        self._moving.write(vertices[self._sources].astype("f4").tobytes())
        view, projection = camera.view(), camera.projection(self.size[0] / self.size[1])
        self._on_screen = self._pixels(vertices[:, :3], projection @ view)
        for shader in self._shaders:
            tell(shader, {"view": view.T, "projection": projection.T})
        self._iris.use(0)
        self._shaders[1]["iris"] = 0
        self._emptied.clear()
        self.target.frame.use()
        self.context.depth_func = "<"
        self.context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        for each in self._solid:
            each.render()
        self.context.disable(moderngl.CULL_FACE)
        for each in self._open:
            each.render()
        return self.target

    def rectangle(self, vertices: Flags) -> Rectangle:
        """Where on the screen some vertices were drawn last, and what lies between them."""
        if not vertices.any():
            return 0, 0, 0, 0
        found = self._on_screen[vertices]
        low = np.clip(np.floor(found.min(axis=0)).astype(int) - MARGIN, 0, self.size)
        high = np.clip(np.ceil(found.max(axis=0)).astype(int) + MARGIN, 0, self.size)
        return int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1])

    def _vertices(self, units: Mapping[str, float], camera: Camera) -> Floats:
        """(v, 6) positions and normals."""
        positions = steadied(self.mesh.positions, deformed(self.mesh, units), camera.turn)
        normals = self.mesh.normals(positions)
        eyes = self.mesh.vertices("eyes")
        spokes = positions[eyes] - self.mesh.eyes[np.where(self.mesh.positions[eyes, 1] > 0.0, 0, 1)]
        normals[eyes] = spokes / np.linalg.norm(spokes, axis=1, keepdims=True)
        return np.concatenate([positions + normals * self._hair[:, None], normals], axis=1)

    def _pixels(self, positions: Floats, onto: Floats) -> Floats:
        """(v, 2) where a (4, 4) matrix puts (v, 3) positions on the screen."""
        flat = positions @ onto[[0, 1, 3], :3].T + onto[[0, 1, 3], 3]
        return np.asarray((0.5 * flat[:, :2] / flat[:, 2:] + 0.5) * self.size)

    def _film(self, mesh: Mesh) -> tuple[moderngl.Buffer, moderngl.Buffer, moderngl.Buffer]:
        """The buffers of an eyeshade."""
        sheet = eyeshade(mesh)
        look = np.array([*np.sqrt(FILM), GLOSS, len(PARTS), COVER])
        return (
            self._buffer(np.concatenate([sheet.positions, sheet.normals], axis=1)),
            self._buffer(np.tile(look, (len(sheet.positions), 1))),
            self._buffer(sheet.triangles, "i4"),
        )

    def _buffer(self, values: Floats | NDArray[np.int32], kind: str = "f4") -> moderngl.Buffer:
        return self.context.buffer(values.astype(kind).tobytes())
