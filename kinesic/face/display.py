"""Where pictures of the face are drawn: an OpenGL context without a window.

The room `face` shows the robot's face: action units become shapes of a mesh, with wrinkles, occlusion and skin, in a
window or in a file. OpenGL is optional everywhere; a machine without it gets one error that tells how to mend it.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

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
    try:
        import moderngl  # noqa: PLC0415 - optional
    except ImportError:
        raise DisplayError(f"moderngl is not installed; {INSTALL_LIBRARY}") from None
    try:
        context = moderngl.create_context(
            standalone=True,
            backend="egl",  # type: ignore[arg-type, unused-ignore] # the stub asks for a dict, the library for a name
        )
    except Exception as error:  # the library raises nothing more precise
        raise DisplayError(f"no OpenGL: {error}; {INSTALL_DRIVER}") from error
    try:
        yield context
    finally:
        context.release()


def available() -> str | None:
    """None where pictures can be drawn, else the reason why not."""
    try:
        with offscreen():
            return None
    except DisplayError as error:
        return str(error)
