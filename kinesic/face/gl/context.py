"""OpenGL context that creates objects and sets drawing state."""

import ctypes
from collections.abc import Callable, Sequence
from typing import Protocol

from kinesic.face.gl import numbers as n
from kinesic.face.gl.functions import FindAddress, Functions
from kinesic.face.gl.programs import Buffer, Program, VertexColumn, Vertices
from kinesic.face.gl.textures import Depth, DepthBuffer, DepthTexture, Framebuffer, Rectangle, Size, Texture

UPLOAD_UNIT = 15  # texture unit for uploads; no shader reads it
SWITCHABLE_STATES = (n.GL_DEPTH_TEST, n.GL_CULL_FACE, n.GL_BLEND)
DEPTH_COMPARISONS = {
    "<": n.GL_LESS,
    "<=": n.GL_LEQUAL,
    "==": n.GL_EQUAL,
    ">": n.GL_GREATER,
    "1": n.GL_ALWAYS,
}


class ContextOwner(Protocol):
    """Creator of an OpenGL context: EGL or the window system."""

    def enter(self) -> None:
        """Make the OpenGL context current."""

    def leave(self) -> None:
        """Make the previous OpenGL context current again."""

    def release(self) -> None:
        """Free the OpenGL context and all its objects."""


class GlContext:
    """OpenGL context that creates objects and draws.

    While it is entered, OpenGL calls apply to it.
    """

    spare = UPLOAD_UNIT

    def __init__(self, find: FindAddress, owner: ContextOwner) -> None:
        """Wrap the current OpenGL context.

        Args:
            find: returns the address of an OpenGL function.
            owner: creator of the context.
        """
        self.functions, self._owner, self.bound = Functions(find), owner, 0  # number of the bound framebuffer
        self.functions.CullFace(n.GL_BACK)
        self.functions.FrontFace(n.GL_COUNTER_CLOCKWISE)

    def __enter__(self) -> "GlContext":
        self._owner.enter()
        return self

    def __exit__(self, *_: object) -> None:
        self._owner.leave()

    def release(self) -> None:
        """Free the OpenGL context and all its objects."""
        self._owner.release()

    @property
    def renderer(self) -> str:
        """Name of the OpenGL renderer."""
        text: object = self.functions.GetString(n.GL_RENDERER)
        return text.decode(errors="replace") if isinstance(text, bytes) else ""

    @property
    def error(self) -> int:
        """Code of the first OpenGL error since this property was last read.

        It is 0 without an error.
        """
        return self.functions.GetError()

    def texture(self, size: Size, components: int, data: bytes | None = None, kind: str = "f1") -> Texture:
        """Create an OpenGL texture.

        Args:
            size: width and height [pixels].
            components: components of a pixel, 1 to 4.
            data: all pixels without gaps; None leaves them undefined.
            kind: component type: `f1` (a byte for 0..1), `f2`, `f4`.
        """
        return Texture(self, size, components, data, kind)

    def depth_texture(self, size: Size) -> DepthTexture:
        """Create a depth texture that shaders can read."""
        return DepthTexture(self, size)

    def depth_buffer(self, size: Size) -> DepthBuffer:
        """Create a depth buffer for depth tests only."""
        return DepthBuffer(self, size)

    def frame(self, colours: Sequence[Texture], depth: Depth | None = None) -> Framebuffer:
        """Create a framebuffer that draws into textures."""
        return Framebuffer(self, colours, depth)

    def program(self, vertex: str, fragment: str) -> Program:
        """Compile and link a vertex and a fragment shader."""
        return Program(self, vertex, fragment)

    def buffer(self, data: bytes) -> Buffer:
        """Create a vertex buffer with constant contents."""
        return Buffer(self, data, len(data))

    def moving_buffer(self, size: int) -> Buffer:
        """Create a vertex buffer of a size [bytes] for repeated writing."""
        return Buffer(self, None, size)

    def vertices(self, program: Program, columns: Sequence[VertexColumn], indices: Buffer | None = None) -> Vertices:
        """Create drawable vertices for a shader program from buffer columns."""
        return Vertices(self, program, columns, indices)

    def switch_on(self, *switches: int) -> None:
        """Enable only the given states (tests, blending), and disable all others."""
        for state in SWITCHABLE_STATES:
            (self.functions.Enable if state in switches else self.functions.Disable)(state)

    def compare_depth(self, sign: str) -> None:
        """Set the operator of the depth test, such as "<".

        `1` always passes.
        """
        self.functions.DepthFunc(DEPTH_COMPARISONS[sign])

    def blend(self, colours: tuple[int, int], alpha: tuple[int, int] | None = None) -> None:
        """Set the blend factors of colours and, optionally, of alpha."""
        self.functions.BlendFuncSeparate(*colours, *(alpha or colours))

    def confine(self, within: Rectangle | None) -> None:
        """Restrict drawing to a rectangle, or remove the restriction with None."""
        if within is None:
            self.functions.Disable(n.GL_SCISSOR_TEST)
        else:
            self.functions.Enable(n.GL_SCISSOR_TEST)
            self.functions.Scissor(*within)

    def bind(self, number: int) -> None:
        """Bind a framebuffer by number.

        0 is the window.
        """
        self.bound = number
        self.functions.BindFramebuffer(n.GL_FRAMEBUFFER, number)

    def use_screen(self, within: Rectangle) -> None:
        """Direct all following drawing into a part of the window."""
        self.bind(0)
        self.confine(None)
        self.switch_on()
        self.functions.Viewport(*within)

    def clear_screen(self, red: float, green: float, blue: float) -> None:
        """Fill the window, or the part set by `confine`, with a colour."""
        self.bind(0)
        self.functions.ClearColor(red, green, blue, 1.0)
        self.functions.Clear(n.GL_COLOR_BUFFER_BIT)

    def finish(self) -> None:
        """Wait until all drawing is complete."""
        self.functions.Finish()

    def elapsed(self, draw: Callable[[], object]) -> float:
        """Measure the drawing time [s] with the clock of the graphics card."""
        gl, nanoseconds = self.functions, ctypes.c_uint64()
        query = gl.new("Queries")
        gl.BeginQuery(n.GL_TIME_ELAPSED, query)
        draw()
        gl.EndQuery(n.GL_TIME_ELAPSED)
        gl.GetQueryObjectui64v(query, n.GL_QUERY_RESULT, ctypes.byref(nanoseconds))
        return nanoseconds.value / 1e9
