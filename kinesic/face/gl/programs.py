"""What draws: programs, the values they are given, and the vertices they run over."""

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from kinesic.face.gl import numbers as n
from kinesic.face.gl.functions import GraphicsError

if TYPE_CHECKING:
    from kinesic.face.gl.context import GlContext

LONGEST_NAME = 256  # bytes of a name
FLOATS: Mapping[int, tuple[str, int]] = MappingProxyType(  # by the type of a uniform: function, and numbers in one
    {
        0x1406: ("Uniform1fv", 1),
        0x8B50: ("Uniform2fv", 2),
        0x8B51: ("Uniform3fv", 3),
        0x8B52: ("Uniform4fv", 4),
        0x8B5A: ("UniformMatrix2fv", 4),
        0x8B5B: ("UniformMatrix3fv", 9),
        0x8B5C: ("UniformMatrix4fv", 16),
    }
)


@dataclass(frozen=True)
class Uniform:
    """A value that a program reads."""

    place: int
    kind: int  # number of its type
    count: int  # of an array, else 1


class Program:
    """A vertex and a fragment shader, compiled."""

    def __init__(self, context: "GlContext", vertex: str, fragment: str) -> None:
        self._context, gl = context, context.functions
        self.number = gl.CreateProgram()
        for kind, source in ((n.VERTEX_SHADER, vertex), (n.FRAGMENT_SHADER, fragment)):
            shader = self._compiled(kind, source)
            gl.AttachShader(self.number, shader)
            gl.DeleteShader(shader)  # when the program goes
        gl.LinkProgram(self.number)
        if not self._asked("Program", self.number, n.LINK_STATUS):
            raise GraphicsError(f"shaders do not fit together: {self._log('Program', self.number)}")
        self._uniforms = dict(self._listed())

    def __contains__(self, name: str) -> bool:
        """Whether a vertex has such an attribute."""
        return self.attribute(name) >= 0

    def attribute(self, name: str) -> int:
        """Place of an attribute of vertices; -1 where a compiler dropped it, for nothing reads it."""
        return self._context.functions.GetAttribLocation(self.number, name.encode())

    def set(self, name: str, value: ArrayLike) -> None:
        """Sets numbers, vectors, matrices and arrays of them, row by row.

        Raises:
            KeyError: nothing reads a uniform of this name.
            GraphicsError: it holds more or fewer numbers.
        """
        gl, uniform = self._context.functions, self._uniforms[name]
        setter, size = FLOATS[uniform.kind]
        values = np.ascontiguousarray(value, dtype=np.float32)
        if values.size != size * uniform.count:
            raise GraphicsError(f"{name} holds {size * uniform.count} numbers, and not {values.size}")
        self.use()
        turned = (0,) if "Matrix" in setter else ()
        getattr(gl, setter)(uniform.place, uniform.count, *turned, values.ctypes.data)

    def sample(self, name: str, place: int) -> None:
        """Has a sampler read the texture at a place."""
        self.use()
        self._context.functions.Uniform1i(self._uniforms[name].place, place)

    def use(self) -> None:
        """Draws with it from now on."""
        self._context.functions.UseProgram(self.number)

    def _compiled(self, kind: int, source: str) -> int:
        gl, text = self._context.functions, source.encode()
        shader = gl.CreateShader(kind)
        gl.ShaderSource(shader, 1, ctypes.byref(ctypes.c_char_p(text)), None)
        gl.CompileShader(shader)
        if not self._asked("Shader", shader, n.COMPILE_STATUS):
            raise GraphicsError(f"a shader does not compile: {self._log('Shader', shader)}")
        return shader

    def _asked(self, kind: str, number: int, what: int) -> int:
        found = ctypes.c_int()
        getattr(self._context.functions, f"Get{kind}iv")(number, what, ctypes.byref(found))
        return found.value

    def _log(self, kind: str, number: int) -> str:
        size = self._asked(kind, number, n.INFO_LOG_LENGTH) + 1
        text = ctypes.create_string_buffer(size)
        getattr(self._context.functions, f"Get{kind}InfoLog")(number, size, None, text)
        return text.value.decode(errors="replace").strip()

    def _listed(self) -> "list[tuple[str, Uniform]]":
        gl, found = self._context.functions, []
        for k in range(self._asked("Program", self.number, n.ACTIVE_UNIFORMS)):
            name, count, kind = ctypes.create_string_buffer(LONGEST_NAME), ctypes.c_int(), ctypes.c_uint()
            gl.GetActiveUniform(self.number, k, LONGEST_NAME, None, ctypes.byref(count), ctypes.byref(kind), name)
            place = gl.GetUniformLocation(self.number, name.value)
            found.append((name.value.decode().partition("[")[0], Uniform(place, kind.value, count.value)))
        return found


class Buffer:
    """Numbers on the graphics card."""

    def __init__(self, context: "GlContext", data: bytes | None, size: int) -> None:
        self._context, self.size = context, size
        self.number = context.functions.new("Buffers")
        self._bind()
        context.functions.BufferData(n.ARRAY_BUFFER, size, data, n.DYNAMIC_DRAW if data is None else n.STATIC_DRAW)

    def write(self, data: bytes) -> None:
        """Replaces its beginning."""
        if len(data) > self.size:
            raise GraphicsError(f"{len(data)} bytes into a buffer of {self.size}")
        self._bind()
        self._context.functions.BufferSubData(n.ARRAY_BUFFER, 0, len(data), data)

    def _bind(self) -> None:
        self._context.functions.BindBuffer(n.ARRAY_BUFFER, self.number)


@dataclass(frozen=True)
class Column:
    """Where an attribute of vertices stands in a buffer of floats."""

    name: str
    buffer: Buffer
    size: int  # numbers of one vertex
    first: int  # of them in a row
    row: int  # numbers of a row


class Vertices:
    """Vertices that a program runs over, as triangles of indices or in their order."""

    def __init__(
        self, context: "GlContext", program: Program, columns: Sequence[Column], indices: Buffer | None = None
    ) -> None:
        self._context, self.program, gl = context, program, context.functions
        self._indexed = indices is not None
        first = columns[0]
        self._count = indices.size // 4 if indices is not None else first.buffer.size // (4 * first.row)
        self.number = gl.new("VertexArrays")
        gl.BindVertexArray(self.number)
        for each in columns:
            place = program.attribute(each.name)
            if place < 0:
                raise GraphicsError(f"the program has no attribute {each.name}")
            gl.BindBuffer(n.ARRAY_BUFFER, each.buffer.number)
            gl.EnableVertexAttribArray(place)
            gl.VertexAttribPointer(place, each.size, n.FLOAT, 0, 4 * each.row, 4 * each.first)
        if indices is not None:
            gl.BindBuffer(n.ELEMENT_ARRAY_BUFFER, indices.number)
        gl.BindVertexArray(0)

    def render(self, mode: int = n.TRIANGLES) -> None:
        """Draws them into the frame in use."""
        gl = self._context.functions
        self.program.use()
        gl.BindVertexArray(self.number)
        if self._indexed:
            gl.DrawElements(mode, self._count, n.UNSIGNED_INT, None)
        else:
            gl.DrawArrays(mode, 0, self._count)
        gl.BindVertexArray(0)
