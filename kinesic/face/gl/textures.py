"""Textures, depth buffers and framebuffers."""

import ctypes
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from kinesic.egl import GraphicsError
from kinesic.face.gl import numbers as n

if TYPE_CHECKING:
    from kinesic.face.gl.context import GlContext

Size = tuple[int, int]  # width, height [pixels]
Rectangle = tuple[int, int, int, int]  # left, low, width, height [pixels]

PIXEL_LAYOUTS = (n.GL_RED, n.GL_RG, n.GL_RGB, n.GL_RGBA)  # OpenGL pixel layouts with 1 to 4 components
COMPONENT_FORMATS: Mapping[
    str, tuple[int, int, tuple[int, int, int, int]]
] = {  # component type, bytes, internal formats for 1 to 4 components
    "f1": (n.GL_UNSIGNED_BYTE, 1, (0x8229, 0x822B, 0x8051, 0x8058)),
    "f2": (n.GL_HALF_FLOAT, 2, (0x822D, 0x822F, 0x881B, 0x881A)),
    "f4": (n.GL_FLOAT, 4, (0x822E, 0x8230, 0x8815, 0x8814)),
}
SWIZZLE_SOURCES = {"R": n.GL_RED, "G": n.GL_GREEN, "B": n.GL_BLUE, "A": n.GL_ALPHA, "0": n.GL_ZERO, "1": n.GL_ONE}


class Texture:
    """Texture on the graphics card, repeated beyond its border unless clamped."""

    def __init__(self, context: "GlContext", size: Size, components: int, data: bytes | None, kind: str) -> None:
        self._context, self.size, self.components, self.dtype = context, size, components, kind
        self.number = context.functions.new("Textures")
        self._bind()
        type_, _, internal_formats = COMPONENT_FORMATS[kind]
        self._shape, self._stored = (PIXEL_LAYOUTS[components - 1], type_), internal_formats[components - 1]
        self._upload(data)
        self.filter = (n.GL_LINEAR, n.GL_LINEAR)

    @property
    def width(self) -> int:
        """Texture width [pixels]."""
        return self.size[0]

    @property
    def height(self) -> int:
        """Texture height [pixels]."""
        return self.size[1]

    @property
    def filter(self) -> tuple[int, int]:
        """Texture filters for minification and magnification."""
        return self._filter

    @filter.setter
    def filter(self, filters: tuple[int, int]) -> None:
        self._filter = filters
        self._set((n.GL_MIN_FILTER, filters[0]), (n.GL_MAG_FILTER, filters[1]))

    def clamp(self) -> None:
        """Repeat the texture's border pixels beyond its border."""
        self._set((n.GL_WRAP_S, n.GL_CLAMP_TO_EDGE), (n.GL_WRAP_T, n.GL_CLAMP_TO_EDGE))

    def swizzle(self, order: str) -> None:
        """Set the texture components read as red, green, blue and alpha.

        Each of the four letters is R, G, B, A, 0 or 1.
        """
        self._set(*((n.GL_SWIZZLE_R + k, SWIZZLE_SOURCES[component]) for k, component in enumerate(order)))

    def write_smaller(self, levels: Sequence[bytes]) -> None:
        """Add the texture's mipmap levels, each half as large.

        The mipmaps of drivers differ between processors.
        """
        self._bind()
        gl = self._context.functions
        gl.PixelStorei(n.GL_UNPACK_ALIGNMENT, 1)
        for level, data in enumerate(levels, start=1):
            size = self.width >> level, self.height >> level
            gl.TexImage2D(n.GL_TEXTURE_2D, level, self._stored, *size, 0, *self._shape, data)
        self._set((n.GL_MAX_LEVEL, len(levels)))

    def use(self, unit: int = 0) -> None:
        """Bind the texture to a texture unit."""
        self._context.functions.ActiveTexture(0x84C0 + unit)
        self._context.functions.BindTexture(n.GL_TEXTURE_2D, self.number)

    def write(self, data: bytes) -> None:
        """Replace all texture pixels, given from the bottom row without gaps."""
        self._check(data)
        self._bind()
        gl = self._context.functions
        gl.PixelStorei(n.GL_UNPACK_ALIGNMENT, 1)
        gl.TexSubImage2D(n.GL_TEXTURE_2D, 0, 0, 0, *self.size, *self._shape, data)

    def read(self) -> bytes:
        """Return the texture's pixels, bottom row first, without row padding."""
        gl, pixels = self._context.functions, ctypes.create_string_buffer(self._bytes)
        self._bind()
        gl.PixelStorei(n.GL_PACK_ALIGNMENT, 1)
        gl.GetTexImage(n.GL_TEXTURE_2D, 0, *self._shape, pixels)
        return pixels.raw

    @property
    def _bytes(self) -> int:
        return self.width * self.height * self.components * COMPONENT_FORMATS[self.dtype][1]

    def _upload(self, data: bytes | None) -> None:
        if data is not None:
            self._check(data)
        gl = self._context.functions
        gl.PixelStorei(n.GL_UNPACK_ALIGNMENT, 1)
        gl.TexImage2D(n.GL_TEXTURE_2D, 0, self._stored, *self.size, 0, *self._shape, data)

    def _check(self, data: bytes) -> None:
        if len(data) != self._bytes:
            raise GraphicsError(
                f"{len(data)} bytes for {self.size[0]} x {self.size[1]} pixels, which need {self._bytes} bytes"
            )

    def _bind(self) -> None:
        self.use(self._context.spare)

    def _set(self, *values: tuple[int, int]) -> None:
        self._bind()
        for name, value in values:
            self._context.functions.TexParameteri(n.GL_TEXTURE_2D, name, value)


class DepthTexture(Texture):
    """Texture of depths in 0..1 that shaders can read."""

    def __init__(self, context: "GlContext", size: Size) -> None:
        self._context, self.size, self.components, self.dtype = context, size, 1, "f4"
        self.number = context.functions.new("Textures")
        self._bind()
        self._shape, self._stored = (n.GL_DEPTH_COMPONENT, n.GL_FLOAT), n.GL_DEPTH_COMPONENT24
        self._upload(None)
        self.filter = (n.GL_NEAREST, n.GL_NEAREST)


class DepthBuffer:
    """Buffer of depths in 0..1 for depth tests only."""

    def __init__(self, context: "GlContext", size: Size) -> None:
        gl, self.size = context.functions, size
        self.number = gl.new("Renderbuffers")
        gl.BindRenderbuffer(n.GL_RENDERBUFFER, self.number)
        gl.RenderbufferStorage(n.GL_RENDERBUFFER, n.GL_DEPTH_COMPONENT24, *size)


Depth = DepthBuffer | DepthTexture


class Framebuffer:
    """Framebuffer that draws into textures, with an optional depth buffer."""

    def __init__(
        self, context: "GlContext", colours: Sequence[Texture], depth: DepthBuffer | DepthTexture | None
    ) -> None:
        gl, self._context, self._colours = context.functions, context, tuple(colours)
        self.size = colours[0].size if colours or depth is None else depth.size
        self.depth_mask = True  # whether drawing and clearing write depths
        self.scissor: Rectangle | None = None  # restricts drawing from the next use on
        self.number = gl.new("Framebuffers")
        with self._bind_temporarily():
            for k, texture in enumerate(colours):
                gl.FramebufferTexture2D(
                    n.GL_FRAMEBUFFER, n.GL_COLOR_ATTACHMENT0 + k, n.GL_TEXTURE_2D, texture.number, 0
                )
            if isinstance(depth, DepthTexture):
                gl.FramebufferTexture2D(n.GL_FRAMEBUFFER, n.GL_DEPTH_ATTACHMENT, n.GL_TEXTURE_2D, depth.number, 0)
            elif depth is not None:
                gl.FramebufferRenderbuffer(n.GL_FRAMEBUFFER, n.GL_DEPTH_ATTACHMENT, n.GL_RENDERBUFFER, depth.number)
            targets = [n.GL_COLOR_ATTACHMENT0 + k for k in range(len(colours))] or [n.GL_NONE]
            gl.DrawBuffers(len(targets), (ctypes.c_uint * len(targets))(*targets))
            gl.ReadBuffer(targets[0])
            status = gl.CheckFramebufferStatus(n.GL_FRAMEBUFFER)
        if status != n.GL_FRAMEBUFFER_COMPLETE:
            raise GraphicsError(f"this OpenGL cannot draw into textures of these formats (0x{status:x})")

    def use(self) -> None:
        """Make this framebuffer the target of drawing."""
        context, gl = self._context, self._context.functions
        context.bind(self.number)
        gl.Viewport(0, 0, *self.size)
        gl.DepthMask(self.depth_mask)
        context.confine(self.scissor)

    def clear(
        self, red: float = 0.0, green: float = 0.0, blue: float = 0.0, alpha: float = 0.0, *, depth: float = 1.0
    ) -> None:
        """Fill the textures with a colour, and clear the depth if writable."""
        gl = self._context.functions
        with self._bind_temporarily():
            gl.DepthMask(self.depth_mask)
            gl.ClearColor(red, green, blue, alpha)
            gl.ClearDepth(depth)
            gl.Clear(n.GL_COLOR_BUFFER_BIT | n.GL_DEPTH_BUFFER_BIT)

    def copy(self, other: "Framebuffer") -> None:
        """Copy another framebuffer's first texture into this framebuffer."""
        gl, (width, height) = self._context.functions, self.size
        with self._bind_temporarily():
            gl.BindFramebuffer(n.GL_READ_FRAMEBUFFER, other.number)
            gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, n.GL_COLOR_BUFFER_BIT, n.GL_NEAREST)

    def read(self, number: int = 0, *, components: int | None = None) -> bytes:
        """Return a texture's pixels, bottom row first, without row padding."""
        texture = self._colours[number]
        component_count = texture.components if components is None else components
        type_, bytes_, _ = COMPONENT_FORMATS[texture.dtype]
        return self._pixels(
            n.GL_COLOR_ATTACHMENT0 + number, PIXEL_LAYOUTS[component_count - 1], type_, component_count * bytes_
        )

    def read_depth(self) -> bytes:
        """Return the depths of all pixels as 4-byte floats."""
        return self._pixels(None, n.GL_DEPTH_COMPONENT, n.GL_FLOAT, 4)

    def _pixels(self, attachment: int | None, layout: int, type_: int, bytes_: int) -> bytes:
        gl, (width, height) = self._context.functions, self.size
        pixels = ctypes.create_string_buffer(width * height * bytes_)
        with self._bind_temporarily():
            if attachment is not None:
                gl.ReadBuffer(attachment)
            gl.PixelStorei(n.GL_PACK_ALIGNMENT, 1)
            gl.ReadPixels(0, 0, width, height, layout, type_, pixels)
        return pixels.raw

    def _bind_temporarily(self) -> "_Bound":
        return _Bound(self._context, self.number)


class _Bound:
    """Context manager that binds a framebuffer, then restores the previous framebuffer."""

    def __init__(self, context: "GlContext", number: int) -> None:
        self._context, self._number = context, number

    def __enter__(self) -> None:
        self._before = self._context.bound
        self._context.bind(self._number)

    def __exit__(self, *_: object) -> None:
        self._context.bind(self._before)
