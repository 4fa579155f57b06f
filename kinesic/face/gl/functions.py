"""OpenGL functions by name, each looked up once."""

import ctypes
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

from kinesic.egl import GraphicsError

FindAddress: TypeAlias = Callable[[str], int]  # address of a function, 0 for an unknown one
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

# Letter in FUNCTION_TABLE -> C type of an argument.
ARGUMENT_TYPES: Mapping[str, NumberType] = {
    "i": ctypes.c_int,  # also sizes
    "u": ctypes.c_uint,  # also enumerations and masks
    "b": ctypes.c_ubyte,
    "f": ctypes.c_float,
    "d": ctypes.c_double,
    "p": ctypes.c_void_p,
    "n": ctypes.c_ssize_t,
}
RESULT_TYPES: Mapping[str, type[ctypes.c_int] | type[ctypes.c_uint] | type[ctypes.c_char_p] | None] = MappingProxyType(
    {"": None, "i": ctypes.c_int, "u": ctypes.c_uint, "s": ctypes.c_char_p}
)
FUNCTION_TABLE = """
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


def _parse_signatures() -> Mapping[str, str]:
    rows = (row.split(maxsplit=1) for row in FUNCTION_TABLE.replace("\n", " ").split(";"))
    return MappingProxyType({row[0]: row[1].strip() if len(row) > 1 else "" for row in rows})


FUNCTION_SIGNATURES = _parse_signatures()


class Functions:
    """OpenGL functions without their prefix `gl`, such as `functions.Clear(mask)`.

    Only functions in `FUNCTION_TABLE` are available.
    """

    def __init__(self, find: FindAddress) -> None:
        self._find = find

    def __getattr__(self, name: str) -> Function:
        if name not in FUNCTION_SIGNATURES:
            raise AttributeError(name)
        arguments, _, result = FUNCTION_SIGNATURES[name].partition(">")
        address = self._find(f"gl{name}")
        if not address:
            raise GraphicsError(f"this OpenGL has no gl{name}")
        function = ctypes.CFUNCTYPE(
            RESULT_TYPES[result.strip()], *(ARGUMENT_TYPES[kind] for kind in arguments.strip())
        )(address)
        self.__dict__[name] = function  # later calls bypass __getattr__
        return function

    def new(self, kind: str) -> int:
        """Create an OpenGL object and return its number.

        The kind is a plural as in OpenGL's function names, such as `Textures`.
        """
        number = ctypes.c_uint()
        getattr(self, f"Gen{kind}")(1, ctypes.byref(number))
        return number.value
