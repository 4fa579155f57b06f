"""Passes of the deferred pipeline: programs, the textures they write, and passes over the whole screen."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

import moderngl
import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats

SHADERS = Path(__file__).parent / "shaders"
VERSION = "#version 330 core\n"

Size: TypeAlias = tuple[int, int]  # width, height [pixels]
Value: TypeAlias = float | Sequence[float] | Floats
Values: TypeAlias = Mapping[str, Value]


def program(
    context: moderngl.Context, vertex: str, fragment: str, defines: Mapping[str, int] | None = None
) -> moderngl.Program:
    """Compiles two files of `shaders`, with numbers for the names that they leave open."""
    head = VERSION + "".join(f"#define {name} {value}\n" for name, value in (defines or {}).items())
    return context.program(
        vertex_shader=VERSION + (SHADERS / f"{vertex}.vert.glsl").read_text(encoding="utf-8"),
        fragment_shader=head + (SHADERS / f"{fragment}.frag.glsl").read_text(encoding="utf-8"),
    )


def tell(shader: moderngl.Program, values: Values, kind: str = "f4") -> None:
    """Sets uniforms of a program, matrices and arrays of vectors row by row."""
    for name, value in values.items():
        member = shader[name]
        if not isinstance(member, moderngl.Uniform):
            raise TypeError(f"{name} is no uniform")
        member.write(np.asarray(value, dtype=kind).tobytes())


def texture(context: moderngl.Context, pixels: Floats, *, half: bool = True) -> moderngl.Texture:
    """A texture of (height, width, components), first row at the bottom, smooth within and clamped at its border."""
    height, width, components = pixels.shape
    kind = "f2" if half else "f4"
    found = context.texture((width, height), components, np.ascontiguousarray(pixels, dtype=kind).tobytes(), dtype=kind)
    found.filter = (moderngl.LINEAR, moderngl.LINEAR)
    found.repeat_x = found.repeat_y = False
    return found


class Target:
    """Textures that a pass writes, with a depth buffer that passes can share."""

    def __init__(
        self, context: moderngl.Context, size: Size, formats: Sequence[str], depth: moderngl.Renderbuffer | None
    ) -> None:
        """Makes the textures.

        Args:
            context: to draw in.
            size: of the textures.
            formats: components and type of each, such as "4f2" or "3f1".
            depth: of the head, or None for a pass that covers everything.
        """
        self.textures = [context.texture(size, int(each[0]), dtype=each[1:]) for each in formats]
        for each in self.textures:
            each.filter = (moderngl.NEAREST, moderngl.NEAREST)
            each.repeat_x = each.repeat_y = False
        self.frame = context.framebuffer(self.textures, depth)

    def read(self, number: int = 0) -> Floats:
        """(height, width, components) pixels of one of the textures, first row on top."""
        found = self.textures[number]
        raw = self.frame.read(components=found.components, attachment=number, alignment=1, dtype=found.dtype)
        pixels = np.frombuffer(raw, "u1" if found.dtype == "f1" else found.dtype)
        return pixels.reshape(found.height, found.width, found.components)[::-1].astype(np.float64)

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3) colours of the first texture, first row on top."""
        raw = self.frame.read(components=3, alignment=1)
        width, height = self.textures[0].size
        return np.ascontiguousarray(np.frombuffer(raw, np.uint8).reshape(height, width, 3)[::-1])


class ScreenPass:
    """A fragment shader over the pixels of the head, or over all, that reads textures and writes a target."""

    def __init__(
        self,
        context: moderngl.Context,
        fragment: str,
        target: Target,
        *,
        everywhere: bool = False,
        defines: Mapping[str, int] | None = None,
    ) -> None:
        self.context, self.target, self.everywhere = context, target, everywhere
        target.frame.depth_mask = False  # the head stays where it is, whatever is drawn or cleared
        self.shader = program(context, "screen", fragment, defines)
        corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype="f4").tobytes())
        self.triangle = context.vertex_array(self.shader, [(corners, "2f", "corner")])

    def draw(
        self,
        inputs: Mapping[str, moderngl.Texture],
        values: Values,
        counts: Mapping[str, int] = MappingProxyType({}),
    ) -> Target:
        """Runs the shader on inputs, by the names of its samplers, and values and counts, by those of its uniforms."""
        for place, (name, found) in enumerate(inputs.items()):
            found.use(place)
            self.shader[name] = place
        tell(self.shader, values)
        tell(self.shader, counts, "i4")
        self.target.frame.use()
        if self.everywhere:
            self.context.disable(moderngl.DEPTH_TEST)
        else:
            self.context.enable(moderngl.DEPTH_TEST)
            self.context.depth_func = ">"
        self.triangle.render(moderngl.TRIANGLES, vertices=3)
        return self.target

    def clear(self) -> Target:
        """The target with zeros."""
        self.target.frame.clear()
        return self.target
