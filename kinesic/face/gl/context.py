"""A context of OpenGL: makes what is drawn with, and holds how it is drawn."""

import ctypes
from collections.abc import Callable, Sequence
from typing import Protocol

from kinesic.face.gl import numbers as n
from kinesic.face.gl.functions import Functions, Lookup
from kinesic.face.gl.programs import Buffer, Column, Program, Vertices
from kinesic.face.gl.textures import Depth, DepthBuffer, DepthTexture, Framebuffer, Rectangle, Size, Texture

SPARE_UNIT = 15  # place of a texture that is changed, which no shader reads from
SWITCHES = (n.DEPTH_TEST, n.CULL_FACE, n.BLEND)
COMPARED = {
    "<": n.LESS,
    "<=": n.LEQUAL,
    "==": n.EQUAL,
    ">": n.GREATER,
    "1": n.ALWAYS,
}


class Owner(Protocol):
    """Whoever made the context: EGL, or the system of windows."""

    def enter(self) -> None:
        """Makes it the one that is drawn in."""

    def leave(self) -> None:
        """Makes the one before it current again."""

    def release(self) -> None:
        """Frees it with all that it holds."""


class GlContext:
    """Draws; while it is entered, calls of OpenGL are meant for it."""

    spare = SPARE_UNIT

    def __init__(self, find: Lookup, owner: Owner) -> None:
        """Takes a context that is current.

        Args:
            find: gives the addresses of its functions.
            owner: of it.
        """
        self.functions, self._owner, self.bound = Functions(find), owner, 0  # the frame that is drawn into
        self.functions.CullFace(n.BACK)
        self.functions.FrontFace(n.COUNTER_CLOCKWISE)

    def __enter__(self) -> "GlContext":
        self._owner.enter()
        return self

    def __exit__(self, *_: object) -> None:
        self._owner.leave()

    def release(self) -> None:
        """Frees it with all that it holds."""
        self._owner.release()

    @property
    def renderer(self) -> str:
        """Name of what draws."""
        text: object = self.functions.GetString(n.RENDERER)
        return text.decode(errors="replace") if isinstance(text, bytes) else ""

    @property
    def error(self) -> int:
        """Number of the first mistake since this was asked last; 0 without one."""
        return self.functions.GetError()

    def texture(self, size: Size, components: int, data: bytes | None = None, kind: str = "f1") -> Texture:
        """Makes a texture.

        Args:
            size: of it.
            components: of a pixel, 1 to 4.
            data: of all pixels, without gaps; None leaves them open.
            kind: of a component: `f1` (a byte for 0..1), `f2`, `f4`.
        """
        return Texture(self, size, components, data, kind)

    def depth_texture(self, size: Size) -> DepthTexture:
        """Makes depths that shaders can read."""
        return DepthTexture(self, size)

    def depth_buffer(self, size: Size) -> DepthBuffer:
        """Makes depths for tests alone."""
        return DepthBuffer(self, size)

    def frame(self, colours: Sequence[Texture], depth: Depth | None = None) -> Framebuffer:
        """Joins textures to draw into."""
        return Framebuffer(self, colours, depth)

    def program(self, vertex: str, fragment: str) -> Program:
        """Compiles shaders."""
        return Program(self, vertex, fragment)

    def buffer(self, data: bytes) -> Buffer:
        """Makes a buffer of numbers that stay."""
        return Buffer(self, data, len(data))

    def moving_buffer(self, size: int) -> Buffer:
        """Makes a buffer of so many bytes that are to be written."""
        return Buffer(self, None, size)

    def vertices(self, program: Program, columns: Sequence[Column], indices: Buffer | None = None) -> Vertices:
        """Joins columns of buffers to vertices for a program."""
        return Vertices(self, program, columns, indices)

    def switch_on(self, *switches: int) -> None:
        """Switches tests and blending on, and all others off."""
        for each in SWITCHES:
            (self.functions.Enable if each in switches else self.functions.Disable)(each)

    def compare_depth(self, sign: str) -> None:
        """Says how a depth must compare to what is there; `1` always does."""
        self.functions.DepthFunc(COMPARED[sign])

    def blend(self, colours: tuple[int, int], alpha: tuple[int, int] | None = None) -> None:
        """Says by how much new and old are weighted; the same for alpha unless it has its own."""
        self.functions.BlendFuncSeparate(*colours, *(alpha or colours))

    def confine(self, within: Rectangle | None) -> None:
        """Touches no pixel outside a rectangle; None: all may be."""
        if within is None:
            self.functions.Disable(n.SCISSOR_TEST)
        else:
            self.functions.Enable(n.SCISSOR_TEST)
            self.functions.Scissor(*within)

    def bind(self, number: int) -> None:
        """Draws into, and reads from, the frame of a number; 0 is the window's."""
        self.bound = number
        self.functions.BindFramebuffer(n.FRAMEBUFFER, number)

    def use_screen(self, within: Rectangle) -> None:
        """Draws into a part of the window from now on."""
        self.bind(0)
        self.confine(None)
        self.switch_on()
        self.functions.Viewport(*within)

    def clear_screen(self, red: float, green: float, blue: float) -> None:
        """Fills the window with a colour."""
        self.bind(0)
        self.functions.ClearColor(red, green, blue, 1.0)
        self.functions.Clear(n.COLOR_BUFFER_BIT)

    def finish(self) -> None:
        """Waits until all is drawn."""
        self.functions.Finish()

    def elapsed(self, draw: Callable[[], object]) -> float:
        """Measures how long the graphics card draws [s], by its own clock."""
        gl, nanoseconds = self.functions, ctypes.c_uint64()
        query = gl.new("Queries")
        gl.BeginQuery(n.TIME_ELAPSED, query)
        draw()
        gl.EndQuery(n.TIME_ELAPSED)
        gl.GetQueryObjectui64v(query, n.QUERY_RESULT, ctypes.byref(nanoseconds))
        return nanoseconds.value / 1e9
