"""Opens a context of OpenGL without a window: EGL finds what can draw, a graphics card or the processor.

Each device has a display of its own, so that neither a screen nor a window system is needed.
"""

import ctypes
from ctypes import CFUNCTYPE, byref, c_char_p, c_int, c_uint, c_void_p
from functools import cache

from kinesic.face.gl.context import GlContext
from kinesic.face.gl.functions import GraphicsError

EGL = "libEGL.so.1"
GL = ("libGL.so.1", "libOpenGL.so.0")  # either serves; a graphics card's EGL knows the functions without them
NEEDED_VERSION = (3, 3)  # version of OpenGL
IN_SOFTWARE = "LIBGL_ALWAYS_SOFTWARE=1 draws on the processor"

_DEVICE_PLATFORM = 0x313F  # numbers of eglext.h and egl.h
_OPENGL_API = 0x30A2
_RENDERABLE, _OPENGL_BIT = 0x3040, 0x0008
_MAJOR, _MINOR, _PROFILE, _CORE, _NONE = 0x3098, 0x30FB, 0x30FD, 0x0001, 0x3038
_DRAW, _READ = 0x3059, 0x305A
_VERSION = 0x1F02  # of gl.h
_MOST = 16  # devices that are tried

_DISPLAY_OF = CFUNCTYPE(c_void_p, c_uint, c_void_p, c_void_p)
_DEVICES = CFUNCTYPE(c_uint, c_int, c_void_p, c_void_p)


class Egl:
    """The library, and the display that contexts of this process share."""

    def __init__(self) -> None:
        """Loads the libraries and starts EGL.

        Raises:
            GraphicsError: something of it is missing; says what.
        """
        egl = _library(EGL)
        self._gl = next((found for name in GL if (found := _library(name))), None)
        if egl is None:
            absent = " and ".join((EGL,) if self._gl else (EGL, GL[0]))
            raise GraphicsError(f"{absent} cannot be loaded")
        self._egl = egl
        self._address = CFUNCTYPE(c_void_p, c_char_p)(("eglGetProcAddress", egl))
        if not self.find("glGetString"):
            raise GraphicsError(f"{GL[0]} cannot be loaded")
        self._create = CFUNCTYPE(c_void_p, c_void_p, c_void_p, c_void_p, c_void_p)(("eglCreateContext", egl))
        self._destroy = CFUNCTYPE(c_uint, c_void_p, c_void_p)(("eglDestroyContext", egl))
        self._make_current = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p, c_void_p)(("eglMakeCurrent", egl))
        self._current = CFUNCTYPE(c_void_p)(("eglGetCurrentContext", egl))
        self._surface = CFUNCTYPE(c_void_p, c_int)(("eglGetCurrentSurface", egl))
        self._current_display = CFUNCTYPE(c_void_p)(("eglGetCurrentDisplay", egl))
        self._display = self._started()
        self._config = self._chosen()

    def find(self, name: str) -> int:
        """Address of a function of OpenGL, 0 for an unknown one."""
        found = self._address(name.encode())
        if found or self._gl is None:
            return int(found or 0)
        try:
            return ctypes.cast(getattr(self._gl, name), c_void_p).value or 0
        except AttributeError:
            return 0

    def create(self) -> int:
        """Makes a context of OpenGL `NEEDED_VERSION`.

        Raises:
            GraphicsError: there is only another version, or none.
        """
        wanted = _list(_MAJOR, NEEDED_VERSION[0], _MINOR, NEEDED_VERSION[1], _PROFILE, _CORE)
        self._bind_api()  # each thread has its own, and others in it may have chosen OpenGL ES
        context = self._create(self._display, self._config, None, wanted)
        if context:
            return int(context)
        found, needed = self._version(), "{}.{}".format(*NEEDED_VERSION)
        raise GraphicsError(f"OpenGL is {found or 'missing'} here, a face needs {needed}; {IN_SOFTWARE}")

    def current(self) -> "Current":
        """Tells what is drawn in now."""
        display = self._current_display()
        return display, self._surface(_DRAW), self._surface(_READ), self._current()

    def restore(self, before: "Current") -> None:
        """Draws in what was drawn in before."""
        display, draw, read, context = before
        self._make_current(display or self._display, draw, read, context)

    def enter(self, context: int) -> None:
        """Draws in a context of ours."""
        self._bind_api()
        if not self._make_current(self._display, None, None, context):
            raise GraphicsError(f"EGL cannot draw without a window (0x{self._egl.eglGetError():x})")

    def destroy(self, context: int) -> None:
        """Frees a context of ours with all that it holds."""
        if self._current() == context:
            self._make_current(self._display, None, None, None)
        self._destroy(self._display, context)

    def _started(self) -> int:
        query, show = (self._address(name) for name in (b"eglQueryDevicesEXT", b"eglGetPlatformDisplayEXT"))
        if not query or not show:
            raise GraphicsError("EGL knows no devices")
        devices, count = (c_void_p * _MOST)(), c_int()
        _DEVICES(query)(_MOST, devices, byref(count))
        if count.value < 1:
            raise GraphicsError("EGL finds no device to draw with")
        start = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p)(("eglInitialize", self._egl))
        for device in devices[: count.value]:  # a card that is there may not be ours to use: then the next
            display = _DISPLAY_OF(show)(_DEVICE_PLATFORM, device, None)
            if display and start(display, None, None):
                return int(display)
        raise GraphicsError(f"EGL does not start (0x{self._egl.eglGetError():x})")

    def _chosen(self) -> c_void_p:
        self._bind_api()
        config, count = c_void_p(), c_int()
        choose = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p, c_int, c_void_p)(("eglChooseConfig", self._egl))
        if not choose(self._display, _list(_RENDERABLE, _OPENGL_BIT), byref(config), 1, byref(count)):
            raise GraphicsError(f"EGL has no way to draw (0x{self._egl.eglGetError():x})")
        return config

    def _bind_api(self) -> None:
        if not CFUNCTYPE(c_uint, c_uint)(("eglBindAPI", self._egl))(_OPENGL_API):
            raise GraphicsError("EGL has no OpenGL")

    def _version(self) -> str:
        """The version that a context without attributes has; empty when there is none."""
        context, told = self._create(self._display, self._config, None, None), b""
        if not context:
            return ""
        before = self.current()
        if self._make_current(self._display, None, None, context):
            told = CFUNCTYPE(c_char_p, c_uint)(self.find("glGetString"))(_VERSION) or b""
            self.restore(before)
        self._destroy(self._display, context)
        return told.decode(errors="replace").partition(" ")[0]


Current = tuple[int | None, int | None, int | None, int | None]  # display, surfaces to draw in and to read, context


class _Offscreen:
    """A context of EGL, as `GlContext` wants its owner."""

    def __init__(self, egl: Egl) -> None:
        self._egl, self._before = egl, list[Current]()
        self._context = egl.create()
        egl.enter(self._context)

    def enter(self) -> None:
        """Draws in it."""
        self._before.append(self._egl.current())
        self._egl.enter(self._context)

    def leave(self) -> None:
        """Draws in what was drawn in before."""
        self._egl.restore(self._before.pop())

    def release(self) -> None:
        """Frees it."""
        self._egl.destroy(self._context)


def open_context() -> GlContext:
    """Opens a context without a window, which is drawn in from now on.

    Raises:
        GraphicsError: nothing can be drawn here; says why.
    """
    egl = started()
    return GlContext(egl.find, _Offscreen(egl))


@cache
def started() -> Egl:
    """Starts EGL once in a process."""
    return Egl()


def _library(name: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


def _list(*numbers: int) -> "ctypes.Array[c_int]":
    return (c_int * (len(numbers) + 1))(*numbers, _NONE)
