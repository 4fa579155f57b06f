"""What is drawn into and read from: textures, depth, and the frames that join them."""

import ctypes
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from kinesic.face.gl import numbers as n
from kinesic.face.gl.functions import GraphicsError

if TYPE_CHECKING:
    from kinesic.face.gl.context import GlContext

Size = tuple[int, int]  # width, height [pixels]
Rectangle = tuple[int, int, int, int]  # left, low, width, height [pixels]

LAYOUTS = (n.RED, n.RG, n.RGB, n.RGBA)  # of one to four components
KINDS: Mapping[str, tuple[int, int, tuple[int, int, int, int]]] = {  # type; bytes; how it is stored, by components
    "f1": (n.UNSIGNED_BYTE, 1, (0x8229, 0x822B, 0x8051, 0x8058)),
    "f2": (n.HALF_FLOAT, 2, (0x822D, 0x822F, 0x881B, 0x881A)),
    "f4": (n.FLOAT, 4, (0x822E, 0x8230, 0x8815, 0x8814)),
}
SWIZZLES = {"R": n.RED, "G": n.GREEN, "B": n.BLUE, "A": n.ALPHA, "0": n.ZERO, "1": n.ONE}


class Texture:
    """A picture on the graphics card, repeated beyond its border until `clamp`."""

    def __init__(self, context: "GlContext", size: Size, components: int, data: bytes | None, kind: str) -> None:
        self._context, self.size, self.components, self.dtype = context, size, components, kind
        self.number = context.functions.new("Textures")
        self._bind()
        type_, _, stored = KINDS[kind]
        self._shape, self._stored = (LAYOUTS[components - 1], type_), stored[components - 1]
        self._upload(data)
        self.filter = (n.LINEAR, n.LINEAR)

    @property
    def width(self) -> int:
        """[pixels]."""
        return self.size[0]

    @property
    def height(self) -> int:
        """[pixels]."""
        return self.size[1]

    @property
    def filter(self) -> tuple[int, int]:
        """The filters that read the texture where its pixels are smaller than the screen's, and where larger."""
        return self._filter

    @filter.setter
    def filter(self, found: tuple[int, int]) -> None:
        self._filter = found
        self._set((n.MIN_FILTER, found[0]), (n.MAG_FILTER, found[1]))

    def clamp(self) -> None:
        """Has its border go on beyond it."""
        self._set((n.WRAP_S, n.CLAMP_TO_EDGE), (n.WRAP_T, n.CLAMP_TO_EDGE))

    def swizzle(self, order: str) -> None:
        """Says which component is read as red, green, blue and alpha: letters of RGBA, 0 and 1."""
        self._set(*((n.SWIZZLE_R + k, SWIZZLES[each]) for k, each in enumerate(order)))

    def write_smaller(self, levels: Sequence[bytes]) -> None:
        """Adds smaller ones, each half as large as the one before: a driver's own differ by processor."""
        self._bind()
        gl = self._context.functions
        gl.PixelStorei(n.UNPACK_ALIGNMENT, 1)
        for level, data in enumerate(levels, start=1):
            size = self.width >> level, self.height >> level
            gl.TexImage2D(n.TEXTURE_2D, level, self._stored, *size, 0, *self._shape, data)
        self._set((n.MAX_LEVEL, len(levels)))

    def use(self, place: int = 0) -> None:
        """Gives it to the sampler of a place."""
        self._context.functions.ActiveTexture(0x84C0 + place)
        self._context.functions.BindTexture(n.TEXTURE_2D, self.number)

    def write(self, data: bytes) -> None:
        """Replaces all pixels; first row at the bottom, without gaps."""
        self._check(data)
        self._bind()
        gl = self._context.functions
        gl.PixelStorei(n.UNPACK_ALIGNMENT, 1)
        gl.TexSubImage2D(n.TEXTURE_2D, 0, 0, 0, *self.size, *self._shape, data)

    def read(self) -> bytes:
        """All pixels; first row at the bottom, without gaps."""
        gl, found = self._context.functions, ctypes.create_string_buffer(self._bytes)
        self._bind()
        gl.PixelStorei(n.PACK_ALIGNMENT, 1)
        gl.GetTexImage(n.TEXTURE_2D, 0, *self._shape, found)
        return found.raw

    @property
    def _bytes(self) -> int:
        return self.width * self.height * self.components * KINDS[self.dtype][1]

    def _upload(self, data: bytes | None) -> None:
        if data is not None:
            self._check(data)
        gl = self._context.functions
        gl.PixelStorei(n.UNPACK_ALIGNMENT, 1)
        gl.TexImage2D(n.TEXTURE_2D, 0, self._stored, *self.size, 0, *self._shape, data)

    def _check(self, data: bytes) -> None:
        if len(data) != self._bytes:
            raise GraphicsError(f"{len(data)} bytes for {self.size[0]} x {self.size[1]} pixels of {self._bytes}")

    def _bind(self) -> None:
        self.use(self._context.spare)

    def _set(self, *values: tuple[int, int]) -> None:
        self._bind()
        for name, value in values:
            self._context.functions.TexParameteri(n.TEXTURE_2D, name, value)


class DepthTexture(Texture):
    """Depths 0..1 that shaders can read."""

    def __init__(self, context: "GlContext", size: Size) -> None:
        self._context, self.size, self.components, self.dtype = context, size, 1, "f4"
        self.number = context.functions.new("Textures")
        self._bind()
        self._shape, self._stored = (n.DEPTH_COMPONENT, n.FLOAT), n.DEPTH_COMPONENT24
        self._upload(None)
        self.filter = (n.NEAREST, n.NEAREST)


class DepthBuffer:
    """Depths 0..1 that only tests read."""

    def __init__(self, context: "GlContext", size: Size) -> None:
        gl, self.size = context.functions, size
        self.number = gl.new("Renderbuffers")
        gl.BindRenderbuffer(n.RENDERBUFFER, self.number)
        gl.RenderbufferStorage(n.RENDERBUFFER, n.DEPTH_COMPONENT24, *size)


Depth = DepthBuffer | DepthTexture


class Framebuffer:
    """Textures that are drawn into together, and the depth that is tested."""

    def __init__(
        self, context: "GlContext", colours: Sequence[Texture], depth: DepthBuffer | DepthTexture | None
    ) -> None:
        gl, self._context, self._colours = context.functions, context, tuple(colours)
        self.size = colours[0].size if colours or depth is None else depth.size
        self.depth_mask = True  # whether depths are written, by clearing, too
        self.scissor: Rectangle | None = None  # the pixels that are written, from its next use
        self.number = gl.new("Framebuffers")
        with self._bound():
            for k, each in enumerate(colours):
                gl.FramebufferTexture2D(n.FRAMEBUFFER, n.COLOR_ATTACHMENT0 + k, n.TEXTURE_2D, each.number, 0)
            if isinstance(depth, DepthTexture):
                gl.FramebufferTexture2D(n.FRAMEBUFFER, n.DEPTH_ATTACHMENT, n.TEXTURE_2D, depth.number, 0)
            elif depth is not None:
                gl.FramebufferRenderbuffer(n.FRAMEBUFFER, n.DEPTH_ATTACHMENT, n.RENDERBUFFER, depth.number)
            targets = [n.COLOR_ATTACHMENT0 + k for k in range(len(colours))] or [n.NONE]
            gl.DrawBuffers(len(targets), (ctypes.c_uint * len(targets))(*targets))
            gl.ReadBuffer(targets[0])
            status = gl.CheckFramebufferStatus(n.FRAMEBUFFER)
        if status != n.FRAMEBUFFER_COMPLETE:
            raise GraphicsError(f"this OpenGL cannot draw into textures such as these (0x{status:x})")

    def use(self) -> None:
        """Draws into it from now on."""
        context, gl = self._context, self._context.functions
        context.bind(self.number)
        gl.Viewport(0, 0, *self.size)
        gl.DepthMask(self.depth_mask)
        context.confine(self.scissor)

    def clear(
        self, red: float = 0.0, green: float = 0.0, blue: float = 0.0, alpha: float = 0.0, *, depth: float = 1.0
    ) -> None:
        """Fills textures with one colour, and depth unless it is masked."""
        gl = self._context.functions
        with self._bound():
            gl.DepthMask(self.depth_mask)
            gl.ClearColor(red, green, blue, alpha)
            gl.ClearDepth(depth)
            gl.Clear(n.COLOR_BUFFER_BIT | n.DEPTH_BUFFER_BIT)

    def copy(self, other: "Framebuffer") -> None:
        """Fills the first texture with the pixels of another's."""
        gl, (width, height) = self._context.functions, self.size
        with self._bound():
            gl.BindFramebuffer(n.READ_FRAMEBUFFER, other.number)
            gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, n.COLOR_BUFFER_BIT, n.NEAREST)

    def read(self, number: int = 0, *, components: int | None = None) -> bytes:
        """Pixels of one of the textures; first row at the bottom, without gaps."""
        found = self._colours[number]
        shown = found.components if components is None else components
        type_, bytes_, _ = KINDS[found.dtype]
        return self._pixels(n.COLOR_ATTACHMENT0 + number, LAYOUTS[shown - 1], type_, shown * bytes_)

    def read_depth(self) -> bytes:
        """Depths of all pixels, as floats of four bytes."""
        return self._pixels(None, n.DEPTH_COMPONENT, n.FLOAT, 4)

    def _pixels(self, attachment: int | None, layout: int, type_: int, bytes_: int) -> bytes:
        gl, (width, height) = self._context.functions, self.size
        found = ctypes.create_string_buffer(width * height * bytes_)
        with self._bound():
            if attachment is not None:
                gl.ReadBuffer(attachment)
            gl.PixelStorei(n.PACK_ALIGNMENT, 1)
            gl.ReadPixels(0, 0, width, height, layout, type_, found)
        return found.raw

    def _bound(self) -> "_Bound":
        return _Bound(self._context, self.number)


class _Bound:
    """For a while another frame is drawn into and read from."""

    def __init__(self, context: "GlContext", number: int) -> None:
        self._context, self._number = context, number

    def __enter__(self) -> None:
        self._before = self._context.bound
        self._context.bind(self._number)

    def __exit__(self, *_: object) -> None:
        self._context.bind(self._before)
