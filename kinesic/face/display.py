"""Where pictures of the face are drawn: an OpenGL context without a window.

The room `face` shows the robot's face: action units become shapes of a mesh, with wrinkles, occlusion and skin, in a
window or in a file. OpenGL is optional everywhere; a machine without it gets one error that tells how to mend it.
"""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol, cast

from kinesic.face.opengl import driver

if TYPE_CHECKING:
    import moderngl

INSTALL_LIBRARY = "pip install 'kinesic[face]'"
INSTALL_DRIVER = "apt-get install libegl1 libgl1"


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
    """The library that draws.

    Raises:
        DisplayError: it is not installed.
    """
    try:
        return cast(Library, importlib.import_module("moderngl"))
    except ImportError:
        raise DisplayError(f"moderngl is not installed; {INSTALL_LIBRARY}") from None


def available() -> str | None:
    """None where pictures can be drawn, else the reason why not."""
    try:
        with offscreen():
            return None
    except DisplayError as error:
        return str(error)
