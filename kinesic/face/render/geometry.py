"""G-buffer of the head: normal, depth, part and surface coordinates per pixel."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.chart import compute_vertex_chart, unroll_mesh
from kinesic.face.assets.eyeshade import make_eyeshade
from kinesic.face.assets.hair import Locks
from kinesic.face.assets.mesh import MESH_PARTS, Mesh
from kinesic.face.assets.paint import PUPIL_RADIUS, Colour
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.programs import Buffer, Program, VertexColumn, Vertices
from kinesic.face.gl.textures import DepthBuffer, Rectangle, Size, Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.passes import MarkPass, PassRegion, Target, compile_program, set_uniforms
from kinesic.face.render.shape import MovingMesh

HeadLayer = Literal["skin", "organs", "lashes", "cloth", "film", "hair", "hair inside"]

PIXEL_MARGIN = 3  # [pixels] margin around a rectangle of drawn vertices
EYESHADE_TRANSMITTANCE = (0.30, 0.95, 0.45)  # fraction of light through the eyeshade, linear RGB
EYESHADE_COVERAGE = 0.5  # fraction of the eyeshade's pixels that are drawn
EYESHADE_GLOSS = 0.5  # specular strength of the eyeshade
HAIR_LAYERS: tuple[HeadLayer, ...] = ("hair", "hair inside")
SKIN_ROW = 6  # [floats] size of a skin vertex's moving attributes: position and normal
HAIR_ROW = 9  # [floats] size of a hair vertex's moving attributes: position, normal and direction of the strands
DEFAULT_HAIR_COLOUR: Colour = (0.0, 0.0, 0.0)  # linear RGB colour of locks if the caller gives no colour
PART_DEPTH_RANGE = 8.0  # [m] depth range per part of the mesh; equal to form.frag.glsl


class Geometry:
    """Renderer of a head into the G-buffer, with layers for other passes."""

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
        hair: Colour = DEFAULT_HAIR_COLOUR,
    ) -> None:
        """Upload the head's constant mesh data to the graphics card.

        Args:
            context: OpenGL context.
            shape: moving mesh to draw.
            drawn_on: corresponding mesh whose chart is used for painting.
            size: size of the G-buffer.
            iris: texture of an eye.
            shaded: whether the head wears an eyeshade.
            locks: locks of hair over the painted scalp.
            hair: colour of the locks.
        """
        mesh = shape.mesh
        self.context, self.mesh, self.size, self._shape = context, mesh, size, shape
        self.depth = context.depth_buffer(size)
        self.target = Target(
            context, size, ("4f4", "4f4"), self.depth
        )  # form (normal, depth, part) and place (chart position)
        self.target.frame.depth_mask = True
        form, _ = self.target.textures
        self._emptied = context.frame([form], self.depth)  # only this texture is read outside the head
        self._iris = iris
        self.drawn_on, self.place = drawn_on, compute_vertex_chart(drawn_on)
        skin = mesh.parts == MESH_PARTS.index("skin")
        first = mesh.triangles[:, 0]
        self._sources, on_chart, triangles = unroll_mesh(self.place, mesh.triangles, skin[first])
        detail = mesh.tips + (mesh.parts == MESH_PARTS.index("eyes")) * (mesh.positions[:, 1] < 0.0)
        fixed = np.column_stack([on_chart, mesh.parts[self._sources], detail[self._sources]])
        self._moving = context.moving_buffer(len(fixed) * 6 * 4)
        thin, cloth = (mesh.parts[first] == MESH_PARTS.index(part) for part in ("lashes", "cloth"))
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
        self.haired, self._hair_at, self._hair = locks is not None, np.zeros((0, 3)), locks
        if locks is not None:
            self._hair_at = locks.positions
            self._moving_hair = self._buffer(np.concatenate([locks.positions, locks.normals, locks.strands], axis=1))
            self._layers |= self._locks(locks)
        skins, organs = (compile_program(context, "geometry", "form", fragment) for fragment in ("skin", "organs"))
        film = compile_program(context, "geometry", "form", "door", "film")
        cloths = compile_program(context, "geometry", "form", "cloth")
        strands = compile_program(context, "geometry", "form", "hair")
        set_uniforms(strands, {"colour": hair})
        self._shaders = (skins, organs, film, cloths, strands)
        self._solid = [self.make_layer(skins, "skin"), self.make_layer(organs, "organs")]
        if self.haired:  # front to back: hair hides the scalp, the head hides the inside of hair
            self._solid = [self.make_layer(strands, "hair"), *self._solid, self.make_layer(strands, "hair inside")]
        self.thin: tuple[HeadLayer, ...] = ("lashes", "film") if shaded else ("lashes",)
        self._open = [self.make_layer(film, "film")] if shaded else []
        if self.dressed:
            self._open.append(self.make_layer(cloths, "cloth"))  # double-sided
        self.pupil = PUPIL_RADIUS  # radius in radii of the eyeball
        eyes = mesh.vertices("eyes")
        self._balls = [eyes[mesh.positions[eyes, 1] > 0.0], eyes[mesh.positions[eyes, 1] < 0.0]]

    def make_layer(self, shader: Program, layer: HeadLayer) -> Vertices:
        """Return a drawable mesh layer for a program with vertex shader `geometry`."""
        moving, still, indices = self._layers[layer]
        row = HAIR_ROW if layer in HAIR_LAYERS else SKIN_ROW
        columns = [
            VertexColumn("position", moving, 3, 0, row),
            VertexColumn("normal", moving, 3, 3, row),
            VertexColumn("strand", moving, 3, 6, row),
            VertexColumn("place", still, 4, 0, 6),
            VertexColumn("matter", still, 2, 4, 6),
        ]
        read = [column for column in columns if column.name in shader]  # compilers remove unused attributes
        return self.context.vertices(shader, read, indices)

    def draw(self, units: Mapping[str, float], camera: Camera) -> Target:
        """Draw the G-buffer of a mesh moved by action units.

        The first texture holds normal, depth and part, the second the chart position or the colour.
        """
        self.move(units, camera)
        return self.render(camera)

    def move(self, units: Mapping[str, float], camera: Camera) -> None:
        """Move the mesh vertices according to action units and camera."""
        vertices = self._shape.vertices(units, camera)
        self._moving.write(vertices[self._sources].astype("f4").tobytes())
        self._move_hair()
        aspect = self.size[0] / self.size[1]
        view, projection, self.lens = camera.view(), camera.projection(aspect), camera.lens(aspect)
        self.on_screen = self._project(vertices[:, :3], projection @ view)
        outline = np.hstack([self.on_screen, self._project(self._hair_at, projection @ view)])
        self.covered = self.rectangle(outline) if "film" not in self._layers else (0, 0, *self.size)
        balls = [self._estimate_eye_axes(ball, vertices) @ view[:3, :3].T for ball in self._balls]
        set_uniforms(self._shaders[1], {"balls": np.array(balls)})

    def light(self, key: Floats) -> None:
        """Set the unit direction (3,) towards the lamp that hair strands reflect."""
        half = key + np.array([0.0, 0.0, 1.0])
        set_uniforms(self._shaders[4], {"half_way": half / np.linalg.norm(half)})

    def _move_hair(self) -> None:
        """Move the locks rigidly with a head that moves."""
        motion = self._shape.head_motion()
        if motion is None or self._hair is None:
            return
        rotation, translation = motion
        self._hair_at = self._hair.positions @ rotation.T + translation
        directions = [item @ rotation.T for item in (self._hair.normals, self._hair.strands)]
        rows = np.concatenate([self._hair_at, *directions], axis=1)
        self._moving_hair.write(rows.astype("f4").tobytes())

    def render(self, camera: Camera) -> Target:
        """Draw the mesh with the positions that were set most recently."""
        view, projection = camera.view(), camera.projection(self.size[0] / self.size[1])
        for shader in self._shaders:
            set_uniforms(shader, {"view": view.T, "projection": projection.T})
        set_uniforms(self._shaders[1], {"pupil": self.pupil})
        self._iris.use(0)
        self._shaders[1].sample("iris", 0)
        self._emptied.clear()
        self.target.frame.use()
        self.context.compare_depth("<")
        self.context.switch_on(gl.GL_DEPTH_TEST, gl.GL_CULL_FACE)
        for vertices in self._solid:
            vertices.render()
        self.context.switch_on(gl.GL_DEPTH_TEST)
        for vertices in self._open:
            vertices.render()
        return self.target

    def parts(self) -> NDArray[np.intp]:
        """Return the (height, width) mesh part last drawn at each pixel.

        Values are indices in MESH_PARTS plus 1; 0 is the background.
        """
        where = self.target.read(0)[..., 3]
        return np.where(where < 0.0, np.floor(where / -PART_DEPTH_RANGE) + 1.0, 0.0).astype(np.intp)

    def positions(self) -> Floats:
        """Return the (height, width, 3) positions [m] in the camera's frame."""
        where = self.target.read(0)[..., 3]
        depth = where + PART_DEPTH_RANGE * np.floor(where / -PART_DEPTH_RANGE)
        (across, up), (width, height) = self.lens, self.size
        right, down = ((np.arange(side) + 0.5) / side * 2.0 - 1.0 for side in (width, height))
        x, y = np.meshgrid(-across * right, up * down)
        return np.stack([x * depth, y * depth, depth], axis=-1)

    def rectangle(self, points: Floats) -> Rectangle:
        """Return the pixel rectangle around (2, k) screen points."""
        low = np.clip(np.floor(points.min(axis=1)).astype(int) - PIXEL_MARGIN, 0, self.size)
        high = np.clip(np.ceil(points.max(axis=1)).astype(int) + PIXEL_MARGIN, 0, self.size)
        return int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1])

    def _estimate_eye_axes(self, ball: NDArray[np.intp], vertices: Floats) -> Floats:
        """Estimate the (3, 3) axes of an eyeball from its normals.

        They point forward, left and up. Its normals are compared with those at rest.
        """
        rest = self.place[ball][:, [2, 0, 1]]
        return np.asarray(np.linalg.lstsq(rest, vertices[ball, 3:], rcond=None)[0])

    def _project(self, positions: Floats, onto: Floats) -> Floats:
        """Project (v, 3) mesh positions to (2, v) screen coordinates."""
        x, y, w = onto[[0, 1, 3], :3] @ positions.T + onto[[0, 1, 3], 3:]
        width, height = self.size
        return np.stack([(0.5 * x / w + 0.5) * width, (0.5 * y / w + 0.5) * height])

    def _film(self, mesh: Mesh) -> tuple[Buffer, Buffer, Buffer]:
        sheet = make_eyeshade(mesh)
        look = np.array([*np.sqrt(EYESHADE_TRANSMITTANCE), EYESHADE_GLOSS, len(MESH_PARTS), EYESHADE_COVERAGE])
        return (
            self._buffer(np.concatenate([sheet.positions, sheet.normals], axis=1)),
            self._buffer(np.tile(look, (len(sheet.positions), 1))),
            self._buffer(sheet.triangles, "i4"),
        )

    def _locks(self, locks: Locks) -> dict[HeadLayer, tuple[Buffer, Buffer, Buffer]]:
        matter = np.tile((len(MESH_PARTS), 0.0), (len(locks.positions), 1))
        moving = self._moving_hair
        still = self._buffer(np.concatenate([locks.places, matter], axis=1))
        return {
            "hair": (moving, still, self._buffer(locks.triangles, "i4")),
            "hair inside": (moving, still, self._buffer(locks.inside, "i4")),
        }

    def _buffer(self, values: Floats | NDArray[np.int32], kind: str = "f4") -> Buffer:
        return self.context.buffer(values.astype(kind).tobytes())


@dataclass(frozen=True, eq=False)
class PositionBuffer:
    """Textures with the position and normal of each head pixel."""

    position: Texture  # [m] position in the camera's frame; last component: part + 1, 0 on the background
    normal: Texture
    depth: DepthBuffer | None = None
    where: PassRegion = "everywhere"


class PositionPass:
    """Pass that unpacks positions and normals, optionally at lower resolution."""

    def __init__(self, context: GlContext, geometry: Geometry, pixels: int = 1) -> None:
        """Create the textures for positions and normals.

        Args:
            context: OpenGL context.
            geometry: source of the G-buffer.
            pixels: G-buffer pixels along a side of one unpacked pixel.
        """
        width, height = (-(-side // pixels) for side in geometry.size)
        self._geometry = geometry
        self._marks = MarkPass(context, ("form", "unpack"), (width, height), ("4f4", "4f4"))
        self.target = self._marks.target
        position, normal = self.target.textures
        self.seen = PositionBuffer(position, normal, self._marks.depth, "marked")
        sides = zip(geometry.size, (width, height), strict=True)
        self._offset = [(pixels // 2 + 0.5) / whole - 0.5 / reduced for whole, reduced in sides]

    def draw(self) -> PositionBuffer:
        """Unpack positions and normals of the last drawn G-buffer."""
        form, _ = self._geometry.target.textures
        self._marks.draw({"form": form}, {"offset": self._offset, "lens": self._geometry.lens})
        return self.seen
