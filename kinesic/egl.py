"""OpenGL contexts without a window, through EGL.

EGL finds a graphics card or draws on the processor. Each device has its own display, so neither a screen nor a window
system is needed.
"""

import ctypes
from ctypes import CFUNCTYPE, byref, c_char_p, c_int, c_uint, c_void_p
from functools import cache

EGL_LIBRARY = "libEGL.so.1"
GL_LIBRARIES = ("libGL.so.1", "libOpenGL.so.0")  # one of these suffices; EGL of a graphics driver needs neither
NEEDED_VERSION = (3, 3)  # required OpenGL version: major, minor
SOFTWARE_HINT = "LIBGL_ALWAYS_SOFTWARE=1 draws on the processor"

_DEVICE_PLATFORM = 0x313F  # EGL_PLATFORM_DEVICE_EXT of eglext.h; the following constants are in egl.h
_OPENGL_API = 0x30A2
_RENDERABLE_TYPE = 0x3040
_OPENGL_BIT = 0x0008
_LIST_END = 0x3038
_MAJOR_VERSION = 0x3098
_MINOR_VERSION = 0x30FB
_PROFILE_MASK = 0x30FD
_CORE_PROFILE = 0x0001
_DRAW_SURFACE = 0x3059
_READ_SURFACE = 0x305A
_VERSION_STRING = 0x1F02  # GL_VERSION of gl.h
_MAX_DEVICES = 16  # largest number of EGL devices that are tried

_PLAIN_ATTRIBUTES = (_RENDERABLE_TYPE, _OPENGL_BIT)  # attributes of contexts that draw only into framebuffer objects
_MUJOCO_ATTRIBUTES = (  # configuration that MuJoCo requests from EGL: name and value in turn
    *(0x3024, 8, 0x3023, 8, 0x3022, 8, 0x3021, 8),  # bits of red, green, blue and alpha
    *(0x3025, 24, 0x3026, 8),  # bits of depth and stencil
    *(0x303F, 0x308E, 0x3033, 0x0001),  # RGB colours, surfaces without a window
    *_PLAIN_ATTRIBUTES,
)

_GetDisplay = CFUNCTYPE(c_void_p, c_uint, c_void_p, c_void_p)
_QueryDevices = CFUNCTYPE(c_uint, c_int, c_void_p, c_void_p)


class GraphicsError(Exception):
    """Failure of EGL or OpenGL, with the reason in the message."""


class Egl:
    """EGL library, and the display on which it creates contexts."""

    def __init__(self) -> None:
        """Load the OpenGL libraries and start EGL.

        Raises:
            GraphicsError: a library, function or device is missing; the message names it.
        """
        egl = _load_library(EGL_LIBRARY)
        self._gl = next((library for name in GL_LIBRARIES if (library := _load_library(name))), None)
        if egl is None:
            absent = " and ".join((EGL_LIBRARY,) if self._gl else (EGL_LIBRARY, GL_LIBRARIES[0]))
            raise GraphicsError(f"{absent} cannot be loaded")
        self._egl = egl
        self._address = CFUNCTYPE(c_void_p, c_char_p)(("eglGetProcAddress", egl))
        if not self.find("glGetString"):
            raise GraphicsError(f"{GL_LIBRARIES[0]} cannot be loaded")
        self._create = CFUNCTYPE(c_void_p, c_void_p, c_void_p, c_void_p, c_void_p)(("eglCreateContext", egl))
        self._destroy = CFUNCTYPE(c_uint, c_void_p, c_void_p)(("eglDestroyContext", egl))
        self._make_current = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p, c_void_p)(("eglMakeCurrent", egl))
        self._current = CFUNCTYPE(c_void_p)(("eglGetCurrentContext", egl))
        self._surface = CFUNCTYPE(c_void_p, c_int)(("eglGetCurrentSurface", egl))
        self._current_display = CFUNCTYPE(c_void_p)(("eglGetCurrentDisplay", egl))
        self._display = self._start_display()
        self._config = self._choose_config(_PLAIN_ATTRIBUTES)

    def find(self, name: str) -> int:
        """Return the address of an OpenGL function, 0 if unknown."""
        address = self._address(name.encode())
        if address or self._gl is None:
            return int(address or 0)
        try:
            return ctypes.cast(getattr(self._gl, name), c_void_p).value or 0
        except AttributeError:
            return 0

    def create(self) -> int:
        """Create an OpenGL core-profile context of version `NEEDED_VERSION`.

        Raises:
            GraphicsError: OpenGL is missing or has another version.
        """
        attributes = _make_attributes(
            _MAJOR_VERSION, NEEDED_VERSION[0], _MINOR_VERSION, NEEDED_VERSION[1], _PROFILE_MASK, _CORE_PROFILE
        )
        self._bind_api()  # the API is set per thread and may be OpenGL ES
        context = self._create(self._display, self._config, None, attributes)
        if context:
            return int(context)
        version, needed = self._read_version(), "{}.{}".format(*NEEDED_VERSION)
        raise GraphicsError(f"OpenGL is {version or 'missing'} here, the face needs {needed}; {SOFTWARE_HINT}")

    def create_for_mujoco(self) -> int:
        """Create an OpenGL context with the deprecated functions that MuJoCo calls.

        Raises:
            GraphicsError: OpenGL has no such context here.
        """
        context = self._create(self._display, self._choose_config(_MUJOCO_ATTRIBUTES), None, None)
        if not context:
            raise GraphicsError(f"EGL has no OpenGL for MuJoCo (0x{self._egl.eglGetError():x})")
        return int(context)

    def current(self) -> "Current":
        """Return the display, surfaces and context current in this thread."""
        display = self._current_display()
        return display, self._surface(_DRAW_SURFACE), self._surface(_READ_SURFACE), self._current()

    def restore(self, previous: "Current") -> None:
        """Make the context current again that `current` has returned."""
        display, draw, read, context = previous
        self._make_current(display or self._display, draw, read, context)

    def enter(self, context: int) -> None:
        """Make an OpenGL context current in this thread, without a surface."""
        self._bind_api()
        if not self._make_current(self._display, None, None, context):
            raise GraphicsError(f"EGL cannot draw without a window (0x{self._egl.eglGetError():x})")

    def destroy(self, context: int) -> None:
        """Free an OpenGL context and all its objects."""
        if self._current() == context:
            self._make_current(self._display, None, None, None)
        self._destroy(self._display, context)

    def _start_display(self) -> int:
        query, show = (self._address(name) for name in (b"eglQueryDevicesEXT", b"eglGetPlatformDisplayEXT"))
        if not query or not show:
            raise GraphicsError("EGL cannot list devices")
        devices, count = (c_void_p * _MAX_DEVICES)(), c_int()
        _QueryDevices(query)(_MAX_DEVICES, devices, byref(count))
        if count.value < 1:
            raise GraphicsError("EGL finds no device to draw with")
        start = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p)(("eglInitialize", self._egl))
        for device in devices[: count.value]:  # the user may lack access to a graphics card
            display = _GetDisplay(show)(_DEVICE_PLATFORM, device, None)
            if display and start(display, None, None):
                return int(display)
        raise GraphicsError(f"EGL does not start (0x{self._egl.eglGetError():x})")

    def _choose_config(self, attributes: tuple[int, ...]) -> c_void_p:
        """Return the first configuration with given attributes, null without one.

        Contexts without a window surface accept null.
        """
        self._bind_api()
        config, count = c_void_p(), c_int()
        choose = CFUNCTYPE(c_uint, c_void_p, c_void_p, c_void_p, c_int, c_void_p)(("eglChooseConfig", self._egl))
        if not choose(self._display, _make_attributes(*attributes), byref(config), 1, byref(count)):
            raise GraphicsError(f"EGL has no suitable configuration (0x{self._egl.eglGetError():x})")
        return config

    def _bind_api(self) -> None:
        if not CFUNCTYPE(c_uint, c_uint)(("eglBindAPI", self._egl))(_OPENGL_API):
            raise GraphicsError("EGL has no OpenGL")

    def _read_version(self) -> str:
        """Return the OpenGL version of a default context, empty without one."""
        context, version = self._create(self._display, self._config, None, None), b""
        if not context:
            return ""
        previous = self.current()
        if self._make_current(self._display, None, None, context):
            version = CFUNCTYPE(c_char_p, c_uint)(self.find("glGetString"))(_VERSION_STRING) or b""
            self.restore(previous)
        self._destroy(self._display, context)
        return version.decode(errors="replace").partition(" ")[0]


Current = tuple[int | None, int | None, int | None, int | None]  # display, surfaces to draw in and to read, context


@cache
def start_egl() -> Egl:
    """Return the `Egl` object of this process, created at first use."""
    return Egl()


def _load_library(name: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


def _make_attributes(*numbers: int) -> "ctypes.Array[c_int]":
    return (c_int * (len(numbers) + 1))(*numbers, _LIST_END)
