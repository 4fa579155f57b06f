"""Passes of the deferred pipeline: programs, the textures they write, and passes over the whole screen."""

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
from kinesic.face.gl.programs import Column, Program
from kinesic.face.gl.textures import DepthBuffer, Framebuffer, Rectangle, Size, Texture

SHADERS = Path(__file__).parent / "shaders"
VERSION = "#version 330 core\n"

PassRegion = Literal["head", "marked", "marking", "everywhere"]
PASSES: Mapping[PassRegion, str] = (
    MappingProxyType(  # how the far plane's depth, 1, must compare to what the depth buffer has
        {"head": ">", "marked": "==", "marking": "1", "everywhere": "1"}
    )
)
TextureFormat: TypeAlias = Literal["f1", "f2", "f4"]  # of a component: a byte for 0..1, or a float of 2 or 4 bytes
Stored: TypeAlias = NDArray[np.uint8 | np.float16 | np.float32]
STORED: Mapping[TextureFormat, np.dtype[np.uint8 | np.float16 | np.float32]] = MappingProxyType(
    {"f1": np.dtype("u1"), "f2": np.dtype("f2"), "f4": np.dtype("f4")}
)
Value: TypeAlias = float | Sequence[float] | Floats
Values: TypeAlias = Mapping[str, Value]


def program(
    context: GlContext, vertex: str, *fragments: str, defines: Mapping[str, int] = MappingProxyType({})
) -> Program:
    """Compiles files of `shaders`; later fragments may use earlier ones, and `defines` sets their constants."""
    head = VERSION + "".join(f"#define {name} {value}\n" for name, value in defines.items())
    return context.program(
        VERSION + (SHADERS / f"{vertex}.vert.glsl").read_text(encoding="utf-8"),
        head + "".join((SHADERS / f"{each}.frag.glsl").read_text(encoding="utf-8") for each in fragments),
    )


def set_uniforms(shader: Program, values: Values) -> None:
    """Sets uniforms of a program, matrices and arrays of vectors row by row."""
    for name, value in values.items():
        shader.set(name, value)


def store_pixels(pixels: Floats | Stored, kind: TextureFormat) -> Stored:
    """Gives pixels as a texture of a kind holds them; those that are stored already stay as they are."""
    scaled = np.rint(255 * pixels) if kind == "f1" and pixels.dtype != STORED[kind] else pixels
    return np.ascontiguousarray(scaled, dtype=STORED[kind])


def texture(context: GlContext, pixels: Floats | Stored, kind: TextureFormat = "f2") -> Texture:
    """Makes a texture that is smooth within and clamped at its border.

    Args:
        context: to draw in.
        pixels: (height, width, components), first row at the bottom; numbers, or as `store_pixels` has them.
        kind: of a component: a byte for 0..1, or a float of 2 or 4 bytes.
    """
    height, width, components = pixels.shape
    found = context.texture((width, height), components, store_pixels(pixels, kind).tobytes(), kind)
    found.clamp()
    return found


class Target:
    """Textures that a pass writes, with a depth buffer that passes can share."""

    def __init__(self, context: GlContext, size: Size, formats: Sequence[str], depth: DepthBuffer | None) -> None:
        """Makes the textures.

        Args:
            context: to draw in.
            size: of the textures.
            formats: components and type of each, such as "4f2" or "3f1".
            depth: of the head, or None for a pass that covers everything.
        """
        textures = [context.texture(size, int(each[0]), kind=each[1:]) for each in formats]
        for each in textures:
            each.filter = (gl.NEAREST, gl.NEAREST)
            each.clamp()
        self._hold(context, textures, depth)

    @classmethod
    def of(cls, context: GlContext, textures: Sequence[Texture], depth: DepthBuffer | None) -> "Target":
        """Makes a target of textures that are there."""
        found = cls.__new__(cls)
        found._hold(context, textures, depth)
        return found

    def _hold(self, context: GlContext, textures: Sequence[Texture], depth: DepthBuffer | None) -> None:
        self._context, self.textures = context, list(textures)
        self.frame = context.frame(self.textures, depth)

    def copy(self, other: "Target") -> None:
        """Fills the first texture with the pixels of another target's; what depth the frame has stays."""
        self.first.copy(other.first)

    @cached_property
    def first(self) -> Framebuffer:
        """The first texture alone."""
        return self._context.frame([self.textures[0]])

    def read(self, number: int = 0) -> Floats:
        """(height, width, components) pixels of one of the textures, first row on top."""
        found = self.textures[number]
        pixels = np.frombuffer(self.frame.read(number), "u1" if found.dtype == "f1" else found.dtype)
        return pixels.reshape(found.height, found.width, found.components)[::-1].astype(np.float64)

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3) colours of the first texture, first row on top."""
        raw = self.frame.read(components=3)
        width, height = self.textures[0].size
        return np.ascontiguousarray(np.frombuffer(raw, np.uint8).reshape(height, width, 3)[::-1])


class ScreenPass:
    """A fragment shader over some pixels of the screen, that reads textures and writes a target."""

    def __init__(
        self,
        context: GlContext,
        target: Target,
        *fragments: str,
        where: PassRegion = "head",
        defines: Mapping[str, int] = MappingProxyType({}),
    ) -> None:
        self.context, self.target, self.where = context, target, where
        target.frame.depth_mask = where == "marking"  # the head stays where it is, whatever is drawn or cleared
        self.shader = program(context, "screen", *fragments, defines=defines)
        self._places: dict[str, int] = {}  # of textures, by the names of their samplers
        corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype="f4").tobytes())
        self.triangle = context.vertices(self.shader, [Column("corner", corners, 2, 0, 2)])

    def draw(
        self,
        inputs: Mapping[str, Texture],
        values: Values = MappingProxyType({}),
        *,
        within: Rectangle | None = None,
        added: bool = False,
    ) -> Target:
        """Runs the shader.

        Args:
            inputs: by the names of its samplers.
            values: by the names of its uniforms.
            within: no pixel outside is touched.
            added: to what the target holds, instead of in its place.
        """
        for name, found in inputs.items():
            if name not in self._places:
                self._places[name] = len(self._places)
                self.shader.sample(name, self._places[name])
            found.use(self._places[name])
        set_uniforms(self.shader, values)
        if within is not None:
            self.target.frame.scissor = within
        self.target.frame.use()
        self.context.switch_on(*([] if self.where == "everywhere" else [gl.DEPTH_TEST]), *([gl.BLEND] if added else []))
        self.context.compare_depth(PASSES[self.where])
        self.context.blend((gl.ONE, gl.ONE))
        self.triangle.render()
        if within is not None:  # it would hold for clearing and copying, too
            self.target.frame.scissor = None
            self.context.confine(None)
        return self.target

    def clear(self, red: float = 0.0, green: float = 0.0, blue: float = 0.0, alpha: float = 0.0) -> Target:
        """Fills the target with one colour."""
        self.target.frame.clear(red, green, blue, alpha)
        return self.target


class Marks:
    """Pixels that a fragment shader does not discard, for passes over those alone, and what it writes there.

    What one shader skips, a software renderer still works out; what the depth test rejects, it does not.
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
        """Marks pixels anew, and none outside a rectangle."""
        self.target.frame.clear(depth=0.0)
        self._pass.draw(inputs, values, within=within)

    def share(self) -> float:
        """Tells which share of the screen is marked."""
        return float((np.frombuffer(self.target.frame.read_depth(), np.float32) > 0.0).mean())
