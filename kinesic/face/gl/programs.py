"""Shader programs, their uniforms, and the vertices they process."""

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from kinesic.egl import GraphicsError
from kinesic.face.gl import numbers as n

if TYPE_CHECKING:
    from kinesic.face.gl.context import GlContext

MAX_NAME_LENGTH = 256  # [bytes] longest name of a uniform variable
UNIFORM_SETTERS: Mapping[int, tuple[str, int]] = MappingProxyType(  # uniform type -> OpenGL function, number of floats
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
    """Location, type and size of a uniform variable."""

    location: int
    kind: int  # OpenGL type
    count: int  # length of an array, otherwise 1


class Program:
    """Compiled vertex and fragment shader."""

    def __init__(self, context: "GlContext", vertex: str, fragment: str) -> None:
        self._context, gl = context, context.functions
        self.number = gl.CreateProgram()
        for kind, source in ((n.GL_VERTEX_SHADER, vertex), (n.GL_FRAGMENT_SHADER, fragment)):
            shader = self._compile(kind, source)
            gl.AttachShader(self.number, shader)
            gl.DeleteShader(shader)  # takes effect when the program is deleted
        gl.LinkProgram(self.number)
        if not self._query("Program", self.number, n.GL_LINK_STATUS):
            raise GraphicsError(f"shaders cannot be linked: {self._log('Program', self.number)}")
        self._uniforms = dict(self._list_uniforms())

    def __contains__(self, name: str) -> bool:
        """Return whether the vertex shader reads an attribute."""
        return self.attribute(name) >= 0

    def attribute(self, name: str) -> int:
        """Return the location of a vertex attribute, -1 if unused."""
        return self._context.functions.GetAttribLocation(self.number, name.encode())

    def set(self, name: str, value: ArrayLike) -> None:
        """Set a uniform of the program to a number, vector or matrix.

        Raises:
            KeyError: the program has no such uniform.
            GraphicsError: the uniform has another size.
        """
        gl, uniform = self._context.functions, self._uniforms[name]
        setter, size = UNIFORM_SETTERS[uniform.kind]
        values = np.ascontiguousarray(value, dtype=np.float32)
        if values.size != size * uniform.count:
            raise GraphicsError(f"{name} needs {size * uniform.count} numbers, not {values.size}")
        self.use()
        transpose = (0,) if "Matrix" in setter else ()
        getattr(gl, setter)(uniform.location, uniform.count, *transpose, values.ctypes.data)

    def sample(self, name: str, location: int) -> None:
        """Bind a sampler to a texture unit."""
        self.use()
        self._context.functions.Uniform1i(self._uniforms[name].location, location)

    def use(self) -> None:
        """Make this shader program current for drawing."""
        self._context.functions.UseProgram(self.number)

    def _compile(self, kind: int, source: str) -> int:
        gl, text = self._context.functions, source.encode()
        shader = gl.CreateShader(kind)
        gl.ShaderSource(shader, 1, ctypes.byref(ctypes.c_char_p(text)), None)
        gl.CompileShader(shader)
        if not self._query("Shader", shader, n.GL_COMPILE_STATUS):
            raise GraphicsError(f"a shader does not compile: {self._log('Shader', shader)}")
        return shader

    def _query(self, kind: str, number: int, parameter: int) -> int:
        value = ctypes.c_int()
        getattr(self._context.functions, f"Get{kind}iv")(number, parameter, ctypes.byref(value))
        return value.value

    def _log(self, kind: str, number: int) -> str:
        size = self._query(kind, number, n.GL_INFO_LOG_LENGTH) + 1
        text = ctypes.create_string_buffer(size)
        getattr(self._context.functions, f"Get{kind}InfoLog")(number, size, None, text)
        return text.value.decode(errors="replace").strip()

    def _list_uniforms(self) -> "list[tuple[str, Uniform]]":
        gl, uniforms = self._context.functions, []
        for k in range(self._query("Program", self.number, n.GL_ACTIVE_UNIFORMS)):
            name, count, kind = ctypes.create_string_buffer(MAX_NAME_LENGTH), ctypes.c_int(), ctypes.c_uint()
            gl.GetActiveUniform(self.number, k, MAX_NAME_LENGTH, None, ctypes.byref(count), ctypes.byref(kind), name)
            location = gl.GetUniformLocation(self.number, name.value)
            uniforms.append((name.value.decode().partition("[")[0], Uniform(location, kind.value, count.value)))
        return uniforms


class Buffer:
    """Buffer of vertex attributes or indices on the graphics card."""

    def __init__(self, context: "GlContext", data: bytes | None, size: int) -> None:
        self._context, self.size = context, size
        self.number = context.functions.new("Buffers")
        self._bind()
        context.functions.BufferData(
            n.GL_ARRAY_BUFFER, size, data, n.GL_DYNAMIC_DRAW if data is None else n.GL_STATIC_DRAW
        )

    def write(self, data: bytes) -> None:
        """Overwrite the buffer with data, from its first byte."""
        if len(data) > self.size:
            raise GraphicsError(f"{len(data)} bytes do not fit into a buffer of {self.size} bytes")
        self._bind()
        self._context.functions.BufferSubData(n.GL_ARRAY_BUFFER, 0, len(data), data)

    def _bind(self) -> None:
        self._context.functions.BindBuffer(n.GL_ARRAY_BUFFER, self.number)


@dataclass(frozen=True)
class VertexColumn:
    """Position of a vertex attribute in a buffer of floats."""

    name: str
    buffer: Buffer
    size: int  # floats per vertex
    first: int  # index of the first float in a row
    row: int  # floats per row


class Vertices:
    """Vertices of a program, as indexed triangles or in buffer order."""

    def __init__(
        self, context: "GlContext", program: Program, columns: Sequence[VertexColumn], indices: Buffer | None = None
    ) -> None:
        self._context, self.program, gl = context, program, context.functions
        self._indexed = indices is not None
        first = columns[0]
        self._count = indices.size // 4 if indices is not None else first.buffer.size // (4 * first.row)
        self.number = gl.new("VertexArrays")
        gl.BindVertexArray(self.number)
        for column in columns:
            location = program.attribute(column.name)
            if location < 0:
                raise GraphicsError(f"the program has no attribute {column.name}")
            gl.BindBuffer(n.GL_ARRAY_BUFFER, column.buffer.number)
            gl.EnableVertexAttribArray(location)
            gl.VertexAttribPointer(location, column.size, n.GL_FLOAT, 0, 4 * column.row, 4 * column.first)
        if indices is not None:
            gl.BindBuffer(n.GL_ELEMENT_ARRAY_BUFFER, indices.number)
        gl.BindVertexArray(0)

    def render(self, mode: int = n.GL_TRIANGLES) -> None:
        """Draw the vertices into the current framebuffer."""
        gl = self._context.functions
        self.program.use()
        gl.BindVertexArray(self.number)
        if self._indexed:
            gl.DrawElements(mode, self._count, n.GL_UNSIGNED_INT, None)
        else:
            gl.DrawArrays(mode, 0, self._count)
        gl.BindVertexArray(0)
