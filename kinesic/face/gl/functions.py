"""Functions of OpenGL by name: each is looked up where the context says, once."""

import ctypes
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

Lookup: TypeAlias = Callable[[str], int]  # address of a function, 0 for an unknown one
Function: TypeAlias = Callable[..., int]

NumberType: TypeAlias = type[
    ctypes.c_int
    | ctypes.c_uint
    | ctypes.c_ubyte
    | ctypes.c_float
    | ctypes.c_double
    | ctypes.c_void_p
    | ctypes.c_ssize_t
]

KINDS: Mapping[str, NumberType] = {
    "i": ctypes.c_int,  # and sizes
    "u": ctypes.c_uint,  # and enumerations, masks
    "b": ctypes.c_ubyte,
    "f": ctypes.c_float,
    "d": ctypes.c_double,
    "p": ctypes.c_void_p,
    "n": ctypes.c_ssize_t,
}
RESULTS: Mapping[str, type[ctypes.c_int] | type[ctypes.c_uint] | type[ctypes.c_char_p] | None] = MappingProxyType(
    {"": None, "i": ctypes.c_int, "u": ctypes.c_uint, "s": ctypes.c_char_p}
)
TABLE = """
ActiveTexture u; AttachShader uu; BeginQuery uu; BindBuffer uu; BindFramebuffer uu; BindRenderbuffer uu;
BindTexture uu; BindVertexArray u; BlendFuncSeparate uuuu; BlitFramebuffer iiiiiiiiuu; BufferData unpu;
BufferSubData unnp; CheckFramebufferStatus u>u; Clear u; ClearColor ffff; ClearDepth d; ColorMask bbbb;
CompileShader u; CreateProgram >u; CreateShader u>u; CullFace u; DeleteShader u; DepthFunc u; DepthMask b; Disable u;
DrawArrays uii; DrawBuffers ip; DrawElements uiup; Enable u; EnableVertexAttribArray u; EndQuery u; Finish;
FramebufferRenderbuffer uuuu; FramebufferTexture2D uuuui; FrontFace u; GenBuffers ip; GenFramebuffers ip;
GenQueries ip; GenRenderbuffers ip; GenTextures ip; GenVertexArrays ip; GetActiveUniform uuipppp;
GetAttribLocation up>i; GetError >u; GetProgramInfoLog uipp; GetProgramiv uup; GetQueryObjectui64v uup;
GetShaderInfoLog uipp; GetShaderiv uup; GetString u>s; GetTexImage uiuup; GetUniformLocation up>i; LinkProgram u;
PixelStorei ui; ReadBuffer u; ReadPixels iiiiuup; RenderbufferStorage uuii; Scissor iiii; ShaderSource uipp;
TexImage2D uiiiiiuup; TexParameteri uui; TexSubImage2D uiiiiiuup; Uniform1fv iip; Uniform1i ii; Uniform2fv iip;
Uniform3fv iip; Uniform4fv iip; UniformMatrix2fv iibp; UniformMatrix3fv iibp; UniformMatrix4fv iibp; UseProgram u;
VertexAttribPointer uiubip; Viewport iiii
"""


def _signatures() -> Mapping[str, str]:
    rows = (row.split(maxsplit=1) for row in TABLE.replace("\n", " ").split(";"))
    return MappingProxyType({row[0]: row[1].strip() if len(row) > 1 else "" for row in rows})


SIGNATURES = _signatures()


class GraphicsError(RuntimeError):
    """OpenGL cannot do what it was asked for; says what."""


class Functions:
    """The functions of `TABLE` without their `gl`, such as `functions.Clear(mask)`."""

    def __init__(self, find: Lookup) -> None:
        self._find = find

    def __getattr__(self, name: str) -> Function:
        if name not in SIGNATURES:
            raise AttributeError(name)
        takes, _, gives = SIGNATURES[name].partition(">")
        address = self._find(f"gl{name}")
        if not address:
            raise GraphicsError(f"this OpenGL has no gl{name}")
        found = ctypes.CFUNCTYPE(RESULTS[gives.strip()], *(KINDS[each] for each in takes.strip()))(address)
        self.__dict__[name] = found  # the next call finds it without us
        return found

    def new(self, kind: str) -> int:
        """Makes an object of OpenGL and gives its number: `Textures`, `Buffers`."""
        number = ctypes.c_uint()
        getattr(self, f"Gen{kind}")(1, ctypes.byref(number))
        return number.value
