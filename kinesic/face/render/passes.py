"""Building blocks of the deferred pipeline: programs, targets and screen passes."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.programs import Program, VertexColumn
from kinesic.face.gl.textures import DepthBuffer, Framebuffer, Rectangle, Size, Texture

SHADER_FOLDER = Path(__file__).parent / "shaders"
VERSION_LINE = "#version 330 core\n"  # first line of every shader

PassRegion = Literal["head", "marked", "marking", "everywhere"]
# Region -> OpenGL comparison of the drawn depth (far plane, 1.0) with the depth buffer; "1" always passes.
DEPTH_TESTS: Mapping[PassRegion, str] = MappingProxyType(
    {"head": ">", "marked": "==", "marking": "1", "everywhere": "1"}
)
TextureFormat: TypeAlias = Literal["f1", "f2", "f4"]  # component type: a byte for 0..1, or a float of 2 or 4 bytes
StoredPixels: TypeAlias = NDArray[np.uint8 | np.float16 | np.float32]
STORED_TYPES: Mapping[TextureFormat, np.dtype[np.uint8 | np.float16 | np.float32]] = MappingProxyType(
    {"f1": np.dtype("u1"), "f2": np.dtype("f2"), "f4": np.dtype("f4")}
)
Value: TypeAlias = float | Sequence[float] | Floats
Values: TypeAlias = Mapping[str, Value]


def compile_program(
    context: GlContext, vertex: str, *fragments: str, defines: Mapping[str, int] = MappingProxyType({})
) -> Program:
    """Compile a program from shader files.

    Fragment files are concatenated in order. Later files may use functions of earlier ones, and `defines` sets
    their constants.
    """
    head = VERSION_LINE + "".join(f"#define {name} {value}\n" for name, value in defines.items())
    return context.program(
        VERSION_LINE + (SHADER_FOLDER / f"{vertex}.vert.glsl").read_text(encoding="utf-8"),
        head + "".join((SHADER_FOLDER / f"{fragment}.frag.glsl").read_text(encoding="utf-8") for fragment in fragments),
    )


def set_uniforms(shader: Program, values: Values) -> None:
    """Set uniforms of a program by name."""
    for name, value in values.items():
        shader.set(name, value)


def store_pixels(pixels: Floats | StoredPixels, kind: TextureFormat) -> StoredPixels:
    """Convert pixels to the component type of a texture format.

    Pixels that have this type already stay unchanged.
    """
    scaled = np.rint(255 * pixels) if kind == "f1" and pixels.dtype != STORED_TYPES[kind] else pixels
    return np.ascontiguousarray(scaled, dtype=STORED_TYPES[kind])


def make_texture(context: GlContext, pixels: Floats | StoredPixels, kind: TextureFormat = "f2") -> Texture:
    """Create a texture with linear filtering, clamped at its border.

    Args:
        context: OpenGL context.
        pixels: (height, width, components) from the bottom row; numbers, or the result of `store_pixels`.
        kind: component type: a byte for 0..1, or a float of 2 or 4 bytes.
    """
    height, width, components = pixels.shape
    created = context.texture((width, height), components, store_pixels(pixels, kind).tobytes(), kind)
    created.clamp()
    return created


class Target:
    """Textures written by a pass, with an optional common depth buffer."""

    def __init__(self, context: GlContext, size: Size, formats: Sequence[str], depth: DepthBuffer | None) -> None:
        """Create the textures of the render target.

        Args:
            context: OpenGL context.
            size: size of the textures.
            formats: components and type of each texture, such as "4f2" or "3f1".
            depth: depth of the head, or None for a pass over everything.
        """
        textures = [context.texture(size, int(item[0]), kind=item[1:]) for item in formats]
        for item in textures:
            item.filter = (gl.GL_NEAREST, gl.GL_NEAREST)
            item.clamp()
        self._hold(context, textures, depth)

    @classmethod
    def of(cls, context: GlContext, textures: Sequence[Texture], depth: DepthBuffer | None) -> "Target":
        """Create a render target of existing textures."""
        target = cls.__new__(cls)
        target._hold(context, textures, depth)
        return target

    def _hold(self, context: GlContext, textures: Sequence[Texture], depth: DepthBuffer | None) -> None:
        self._context, self.textures = context, list(textures)
        self.frame = context.frame(self.textures, depth)

    def copy(self, other: "Target") -> None:
        """Copy the first texture of another render target, without its depth."""
        self.first.copy(other.first)

    @cached_property
    def first(self) -> Framebuffer:
        """Framebuffer of the first texture alone."""
        return self._context.frame([self.textures[0]])

    def read(self, number: int = 0) -> Floats:
        """Return the pixels of a target's texture, top row first.

        The shape is (height, width, components).
        """
        source = self.textures[number]
        pixels = np.frombuffer(self.frame.read(number), "u1" if source.dtype == "f1" else source.dtype)
        return pixels.reshape(source.height, source.width, source.components)[::-1].astype(np.float64)

    def pixels(self) -> NDArray[np.uint8]:
        """Return the colours of the target's first texture, top row first.

        The shape is (height, width, 3).
        """
        raw = self.frame.read(components=3)
        width, height = self.textures[0].size
        return np.ascontiguousarray(np.frombuffer(raw, np.uint8).reshape(height, width, 3)[::-1])


class ScreenPass:
    """Fragment shader over a region of the screen that writes a target."""

    def __init__(
        self,
        context: GlContext,
        target: Target,
        *fragments: str,
        where: PassRegion = "head",
        defines: Mapping[str, int] = MappingProxyType({}),
    ) -> None:
        self.context, self.target, self.where = context, target, where
        target.frame.depth_mask = where == "marking"  # other passes must not change the depth of the head
        self.shader = compile_program(context, "screen", *fragments, defines=defines)
        self._places: dict[str, int] = {}  # texture unit by sampler name
        corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype="f4").tobytes())
        self.triangle = context.vertices(self.shader, [VertexColumn("corner", corners, 2, 0, 2)])

    def draw(
        self,
        inputs: Mapping[str, Texture],
        values: Values = MappingProxyType({}),
        *,
        within: Rectangle | None = None,
        added: bool = False,
    ) -> Target:
        """Run the fragment shader over the screen region.

        Args:
            inputs: textures by sampler name.
            values: values by uniform name.
            within: rectangle to which drawing is restricted.
            added: whether to add to the target instead of replacing it.
        """
        for name, source in inputs.items():
            if name not in self._places:
                self._places[name] = len(self._places)
                self.shader.sample(name, self._places[name])
            source.use(self._places[name])
        set_uniforms(self.shader, values)
        if within is not None:
            self.target.frame.scissor = within
        self.target.frame.use()
        self.context.switch_on(
            *([] if self.where == "everywhere" else [gl.GL_DEPTH_TEST]), *([gl.GL_BLEND] if added else [])
        )
        self.context.compare_depth(DEPTH_TESTS[self.where])
        self.context.blend((gl.GL_ONE, gl.GL_ONE))
        self.triangle.render()
        if within is not None:  # otherwise it would also apply to clearing and copying
            self.target.frame.scissor = None
            self.context.confine(None)
        return self.target

    def clear(self, red: float = 0.0, green: float = 0.0, blue: float = 0.0, alpha: float = 0.0) -> Target:
        """Fill the pass's target with one colour."""
        self.target.frame.clear(red, green, blue, alpha)
        return self.target


class MarkPass:
    """Pass that marks pixels in a depth buffer for later passes.

    Pixels that the fragment shader discards stay unmarked. The depth test then skips them even on software renderers,
    which would otherwise evaluate the shader.
    """

    def __init__(self, context: GlContext, fragments: Sequence[str], size: Size, formats: Sequence[str] = ()) -> None:
        self.depth = context.depth_buffer(size)
        self.target = Target(context, size, formats, self.depth)
        self._pass = ScreenPass(context, self.target, *fragments, where="marking")

    def draw(
        self,
        inputs: Mapping[str, Texture],
        values: Values = MappingProxyType({}),
        *,
        within: Rectangle | None = None,
    ) -> None:
        """Clear the marks and mark pixels, optionally only in a rectangle."""
        self.target.frame.clear(depth=0.0)
        self._pass.draw(inputs, values, within=within)

    def measure_marked_fraction(self) -> float:
        """Return the fraction of the screen that is marked."""
        return float((np.frombuffer(self.target.frame.read_depth(), np.float32) > 0.0).mean())
