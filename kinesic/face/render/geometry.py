"""The head's G-buffer: what each pixel of it shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.chart import unroll, vertex_chart
from kinesic.face.assets.eyeshade import eyeshade
from kinesic.face.assets.hair import Locks
from kinesic.face.assets.mesh import PARTS, Mesh
from kinesic.face.assets.paint import PUPIL, Colour
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.programs import Buffer, Column, Program, Vertices
from kinesic.face.gl.textures import DepthBuffer, Rectangle, Size, Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.passes import Marks, PassRegion, Target, program, set_uniforms
from kinesic.face.render.shape import MovingMesh

HeadLayer = Literal["skin", "organs", "lashes", "cloth", "film", "hair", "hair inside"]

PIXEL_MARGIN = 3  # [pixels] round a rectangle
FILM = (0.30, 0.95, 0.45)  # what an eyeshade lets through, linear
COVER = 0.5  # share of its pixels that are drawn
GLOSS = 0.5
BALD: Colour = (0.0, 0.0, 0.0)
APART = 8.0  # as form.frag.glsl has it


class Geometry:
    """Draws a head into the G-buffer, and lets others draw it elsewhere."""

    def __init__(
        self,
        context: GlContext,
        shape: MovingMesh,
        drawn_on: Mesh,
        size: Size,
        iris: Texture,
        *,
        shaded: bool = False,
        locks: Locks | None = None,
        hair: Colour = BALD,
    ) -> None:
        """Uploads what does not move.

        Args:
            context: to draw in.
            shape: that is drawn.
            drawn_on: the same faces at the places of the head whose chart everything is painted in.
            size: of the G-buffer.
            iris: how an eye is painted.
            shaded: whether the head wears an eyeshade.
            locks: of hair, over what is painted on the scalp.
            hair: their colour.
        """
        mesh = shape.mesh
        self.context, self.mesh, self.size, self._shape = context, mesh, size, shape
        self.depth = context.depth_buffer(size)
        self.target = Target(context, size, ("4f4", "4f4"), self.depth)  # form, place
        self.target.frame.depth_mask = True
        form, _ = self.target.textures
        self._emptied = context.frame([form], self.depth)  # what is not on the head is read nowhere else
        self._iris = iris
        self.drawn_on, self.place = drawn_on, vertex_chart(drawn_on)
        skin = mesh.parts == PARTS.index("skin")
        self._sources, on_chart, triangles = unroll(self.place, mesh.triangles)
        detail = mesh.tips + (mesh.parts == PARTS.index("eyes")) * (mesh.positions[:, 1] < 0.0)
        fixed = np.column_stack([on_chart, mesh.parts[self._sources], detail[self._sources]])
        self._moving = context.moving_buffer(len(fixed) * 6 * 4)
        first = mesh.triangles[:, 0]
        thin, cloth = (mesh.parts[first] == PARTS.index(part) for part in ("lashes", "cloth"))
        still = self._buffer(fixed)
        self._layers: dict[HeadLayer, tuple[Buffer, Buffer, Buffer]] = {
            "skin": (self._moving, still, self._buffer(triangles[skin[first]], "i4")),
            "organs": (self._moving, still, self._buffer(triangles[~skin[first] & ~thin & ~cloth], "i4")),
            "lashes": (self._moving, still, self._buffer(triangles[thin], "i4")),
        }
        self.dressed = bool(cloth.any())
        if self.dressed:
            self._layers["cloth"] = (self._moving, still, self._buffer(triangles[cloth], "i4"))
        if shaded:
            self._layers["film"] = self._film(mesh)
        self.haired, self._hair_at = locks is not None, np.zeros((0, 3))
        if locks is not None:
            self._hair_at = locks.positions
            self._layers |= self._locks(locks)
        skins, organs = (program(context, "geometry", "form", fragment) for fragment in ("skin", "organs"))
        film = program(context, "geometry", "form", "door", "film")
        cloths = program(context, "geometry", "form", "cloth")
        strands = program(context, "geometry", "form", "hair")
        set_uniforms(strands, {"colour": hair})
        self._shaders = (skins, organs, film, cloths, strands)
        self._solid = [self.drawn(skins, "skin"), self.drawn(organs, "organs")]
        if self.haired:  # what is drawn first hides most of the rest: hair the scalp, and the head the inside of hair
            self._solid = [self.drawn(strands, "hair"), *self._solid, self.drawn(strands, "hair inside")]
        self.thin: tuple[HeadLayer, ...] = ("lashes", "film") if shaded else ("lashes",)
        self._open = [self.drawn(film, "film")] if shaded else []
        if self.dressed:
            self._open.append(self.drawn(cloths, "cloth"))  # seen from both sides
        self.pupil = PUPIL  # half as wide as it is, in radii of the eyeball
        eyes = mesh.vertices("eyes")
        self._balls = [eyes[mesh.positions[eyes, 1] > 0.0], eyes[mesh.positions[eyes, 1] < 0.0]]

    def drawn(self, shader: Program, layer: HeadLayer) -> Vertices:
        """Gives one of the layers, for a program with the vertex shader `geometry`."""
        moving, still, indices = self._layers[layer]
        columns = [
            Column("position", moving, 3, 0, 6),
            Column("normal", moving, 3, 3, 6),
            Column("place", still, 4, 0, 6),
            Column("matter", still, 2, 4, 6),
        ]
        read = [each for each in columns if each.name in shader]  # a compiler drops what nothing reads
        return self.context.vertices(shader, read, indices)

    def draw(self, units: Mapping[str, float], camera: Camera) -> Target:
        """Draws the G-buffer: normal with depth and part; place in the chart, or colour."""
        self.move(units, camera)
        return self.render(camera)

    def move(self, units: Mapping[str, float], camera: Camera) -> None:
        """Puts the vertices where action units and camera have them."""
        vertices = self._shape.vertices(units, camera)
        self._moving.write(vertices[self._sources].astype("f4").tobytes())
        aspect = self.size[0] / self.size[1]
        view, projection, self.lens = camera.view(), camera.projection(aspect), camera.lens(aspect)
        self.on_screen = self._pixels(vertices[:, :3], projection @ view)
        outline = np.hstack([self.on_screen, self._pixels(self._hair_at, projection @ view)])
        self.covered = self.rectangle(outline) if "film" not in self._layers else (0, 0, *self.size)
        balls = [self._turned(ball, vertices) @ view[:3, :3].T for ball in self._balls]
        set_uniforms(self._shaders[1], {"balls": np.array(balls)})

    def render(self, camera: Camera) -> Target:
        """Draws the vertices as they were moved last."""
        view, projection = camera.view(), camera.projection(self.size[0] / self.size[1])
        for shader in self._shaders:
            set_uniforms(shader, {"view": view.T, "projection": projection.T})
        set_uniforms(self._shaders[1], {"pupil": self.pupil})
        self._iris.use(0)
        self._shaders[1].sample("iris", 0)
        self._emptied.clear()
        self.target.frame.use()
        self.context.compare_depth("<")
        self.context.switch_on(gl.DEPTH_TEST, gl.CULL_FACE)
        for each in self._solid:
            each.render()
        self.context.switch_on(gl.DEPTH_TEST)
        for each in self._open:
            each.render()
        return self.target

    def parts(self) -> NDArray[np.intp]:
        """(height, width) part last drawn at each pixel, as its index in PARTS plus 1; 0 is the background."""
        where = self.target.read(0)[..., 3]
        return np.where(where < 0.0, np.floor(where / -APART) + 1.0, 0.0).astype(np.intp)

    def positions(self) -> Floats:
        """(height, width, 3) [m] where that is in the camera's frame."""
        where = self.target.read(0)[..., 3]
        depth = where + APART * np.floor(where / -APART)
        (across, up), (width, height) = self.lens, self.size
        right, down = ((np.arange(side) + 0.5) / side * 2.0 - 1.0 for side in (width, height))
        x, y = np.meshgrid(-across * right, up * down)
        return np.stack([x * depth, y * depth, depth], axis=-1)

    def rectangle(self, points: Floats) -> Rectangle:
        """Finds the pixels round (2, k) points of the screen, and between them."""
        low = np.clip(np.floor(points.min(axis=1)).astype(int) - PIXEL_MARGIN, 0, self.size)
        high = np.clip(np.ceil(points.max(axis=1)).astype(int) + PIXEL_MARGIN, 0, self.size)
        return int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1])

    def _turned(self, ball: NDArray[np.intp], vertices: Floats) -> Floats:
        """(3, 3) where forward, left and up of an eyeball point, one row each: its normals against those at rest."""
        rest = self.place[ball][:, [2, 0, 1]]
        return np.asarray(np.linalg.lstsq(rest, vertices[ball, 3:], rcond=None)[0])

    def _pixels(self, positions: Floats, onto: Floats) -> Floats:
        """(2, v) where a (4, 4) matrix puts (v, 3) positions on the screen."""
        x, y, w = onto[[0, 1, 3], :3] @ positions.T + onto[[0, 1, 3], 3:]
        width, height = self.size
        return np.stack([(0.5 * x / w + 0.5) * width, (0.5 * y / w + 0.5) * height])

    def _film(self, mesh: Mesh) -> tuple[Buffer, Buffer, Buffer]:
        sheet = eyeshade(mesh)
        look = np.array([*np.sqrt(FILM), GLOSS, len(PARTS), COVER])
        return (
            self._buffer(np.concatenate([sheet.positions, sheet.normals], axis=1)),
            self._buffer(np.tile(look, (len(sheet.positions), 1))),
            self._buffer(sheet.triangles, "i4"),
        )

    def _locks(self, locks: Locks) -> dict[HeadLayer, tuple[Buffer, Buffer, Buffer]]:
        matter = np.tile((len(PARTS), 0.0), (len(locks.positions), 1))
        moving = self._buffer(np.concatenate([locks.positions, locks.normals], axis=1))
        still = self._buffer(np.concatenate([locks.places, matter], axis=1))
        return {
            "hair": (moving, still, self._buffer(locks.triangles, "i4")),
            "hair inside": (moving, still, self._buffer(locks.inside, "i4")),
        }

    def _buffer(self, values: Floats | NDArray[np.int32], kind: str = "f4") -> Buffer:
        return self.context.buffer(values.astype(kind).tobytes())


@dataclass(frozen=True, eq=False)
class PositionBuffer:
    """Where each pixel of the head is and where it faces; textures as large as each other."""

    position: Texture  # [m] in the camera's frame; part + 1, 0 on the background
    normal: Texture
    depth: DepthBuffer | None = None
    where: PassRegion = "everywhere"


class PositionPass:
    """Unpacks positions and normals of the G-buffer, in whole or with fewer pixels."""

    def __init__(self, context: GlContext, geometry: Geometry, pixels: int = 1) -> None:
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
        """Unpacks what was drawn last."""
        form, _ = self._geometry.target.textures
        self._marks.draw({"form": form}, {"offset": self._offset, "lens": self._geometry.lens})
        return self.seen
