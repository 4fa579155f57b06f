"""Where pictures of the face are drawn: an OpenGL context without a window.

The room `face` shows the robot's face: action units become shapes of a mesh, with wrinkles, occlusion and skin, in a
window or in a file. OpenGL is optional everywhere; a machine without it gets one error that tells how to mend it.
"""

import ctypes
import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import CFUNCTYPE, byref, c_char_p, c_int, c_uint, c_void_p
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    import moderngl

EGL = "libEGL.so.1"
GL = ("libGL.so.1", "libOpenGL.so.0")  # either serves
NEEDED = (3, 3)  # version of OpenGL

_DEVICE_PLATFORM = 0x313F  # numbers of eglext.h and egl.h
_OPENGL_API = 0x30A2
_RENDERABLE, _OPENGL_BIT = 0x3040, 0x0008
_MAJOR, _MINOR, _PROFILE, _CORE, _NONE = 0x3098, 0x30FB, 0x30FD, 0x0001, 0x3038
_VERSION = 0x1F02  # of gl.h
INSTALL_LIBRARY = "pip install 'kinesic[face]'"
INSTALL_DRIVER = "apt-get install libegl1 libgl1"


@dataclass(frozen=True)
class GraphicsDriver:
    """What was found on this machine."""

    egl: str = ""  # names of shared libraries
    gl: str = ""
    fault: str = ""  # why nothing can be drawn


@cache
def driver() -> GraphicsDriver:
    """Looks once for what OpenGL needs here; nothing stays open."""
    egl, found = _library(EGL), next((name for name in GL if _library(name)), "")
    if egl is None or not found:
        absent = " and ".join(name for name, there in ((EGL, egl), (GL[0], found)) if not there)
        return GraphicsDriver(fault=f"{absent} cannot be loaded")
    return GraphicsDriver(EGL, found, _fault(egl, found))


@cache
def _library(name: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


def _fault(egl: ctypes.CDLL, gl: str) -> str:
    """Opens a context as a picture would, and says what hinders it; empty when nothing does."""
    find = CFUNCTYPE(c_void_p, c_char_p)(("eglGetProcAddress", egl))
    query, show = find(b"eglQueryDevicesEXT"), find(b"eglGetPlatformDisplayEXT")
    if not query or not show:
        return "EGL knows no devices"
    device, count = c_void_p(), c_int()
    CFUNCTYPE(c_uint, c_int, c_void_p, c_void_p)(query)(1, byref(device), byref(count))
    if count.value < 1:
        return "EGL finds no device to draw with"
    screen = CFUNCTYPE(c_void_p, c_uint, c_void_p, c_void_p)(show)(_DEVICE_PLATFORM, device, None)
    if not screen or not CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p)(("eglInitialize", egl))(screen, None, None):
        return f"EGL does not start (0x{egl.eglGetError():x})"
    if not CFUNCTYPE(c_uint, c_uint)(("eglBindAPI", egl))(_OPENGL_API):
        return "EGL has no OpenGL"
    config = c_void_p()
    choose = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p, c_int, c_void_p)(("eglChooseConfig", egl))
    if not choose(screen, _list(_RENDERABLE, _OPENGL_BIT), byref(config), 1, byref(count)):
        return f"EGL has no way to draw (0x{egl.eglGetError():x})"
    create = CFUNCTYPE(c_void_p, c_void_p, c_void_p, c_void_p, c_void_p)(("eglCreateContext", egl))
    context = create(screen, config, None, _list(_MAJOR, NEEDED[0], _MINOR, NEEDED[1], _PROFILE, _CORE))
    if context:
        CFUNCTYPE(c_uint, c_void_p, c_void_p)(("eglDestroyContext", egl))(screen, context)
        return ""
    found, needed = _version(egl, gl, screen, create(screen, config, None, None)), "{}.{}".format(*NEEDED)
    return f"OpenGL is {found or 'missing'} here, a face needs {needed}; LIBGL_ALWAYS_SOFTWARE=1 draws on the processor"


def _version(egl: ctypes.CDLL, gl: str, screen: int, context: int | None) -> str:
    """The version that a context without attributes has; empty when there is none. The context is closed."""
    if not context:
        return ""
    current = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p, c_void_p)(("eglMakeCurrent", egl))
    told = b""
    if current(screen, None, None, context):
        told = CFUNCTYPE(c_char_p, c_uint)(("glGetString", ctypes.CDLL(gl)))(_VERSION) or b""
        current(screen, None, None, None)
    CFUNCTYPE(c_uint, c_void_p, c_void_p)(("eglDestroyContext", egl))(screen, context)
    return told.decode(errors="replace").partition(" ")[0]


def _list(*numbers: int) -> "ctypes.Array[c_int]":
    return (c_int * (len(numbers) + 1))(*numbers, _NONE)


class DisplayError(RuntimeError):
    """Nothing can be drawn on this machine; says which command mends it."""


@contextmanager
def offscreen() -> Iterator["moderngl.Context"]:
    """Opens an EGL context that needs neither a screen nor a graphics card, and releases it at the end.

    Raises:
        DisplayError: moderngl is not installed, or there is no OpenGL driver.
    """
    drawing, found = library(), driver()
    if found.fault:
        raise DisplayError(f"no OpenGL: {found.fault}; {INSTALL_DRIVER}")
    context = drawing.create_context(standalone=True, backend="egl", libegl=found.egl, libgl=found.gl)
    try:
        yield context
    finally:
        context.release()


class Library(Protocol):
    """What is used of moderngl to begin with; its own types want tables where the library wants names."""

    def create_context(self, *, standalone: bool = ..., **settings: object) -> "moderngl.Context":
        """Opens a context, or takes one that is there."""


def library() -> Library:
    """Imports moderngl, which draws.

    Raises:
        DisplayError: it is not installed.
    """
    try:
        return cast(Library, importlib.import_module("moderngl"))
    except ImportError:
        raise DisplayError(f"moderngl is not installed; {INSTALL_LIBRARY}") from None


def available() -> str | None:
    """Tells why no picture can be drawn here; None where it can."""
    try:
        with offscreen():
            return None
    except DisplayError as error:
        return str(error)
