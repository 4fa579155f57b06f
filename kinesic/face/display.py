"""Where pictures of the face are drawn: an OpenGL context without a window.

The room `face` shows the robot's face: action units become shapes of a mesh, with wrinkles, occlusion and skin, in a
window or in a file. OpenGL is optional everywhere; a machine without it gets one error that tells how to mend it.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from kinesic.face.gl.context import GlContext
from kinesic.face.gl.egl import open_context
from kinesic.face.gl.functions import GraphicsError

INSTALL_DRIVER = "apt-get install libegl1 libgl1"
INSTALL_WINDOWS = "pip install 'kinesic[face]'"


class DisplayError(RuntimeError):
    """Nothing can be drawn on this machine; says which command mends it."""


@contextmanager
def offscreen() -> Iterator[GlContext]:
    """Opens an EGL context that needs neither a screen nor a graphics card, and releases it at the end.

    Raises:
        DisplayError: there is no OpenGL driver.
    """
    try:
        context = open_context()
    except GraphicsError as error:
        raise DisplayError(f"no OpenGL: {error}; {INSTALL_DRIVER}") from None
    try:
        yield context
    finally:
        context.release()


def available() -> str | None:
    """Tells why no picture can be drawn here; None where it can."""
    try:
        with offscreen():
            return None
    except DisplayError as error:
        return str(error)
