"""Offscreen OpenGL context for pictures of the face.

The package `face` renders the robot's face: action units deform a mesh, which is drawn with wrinkles, ambient occlusion
and skin shading, in a window or in a file. OpenGL is optional everywhere; a machine without it gets one error that
names the remedy.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING

from kinesic.extras import install_extra

if TYPE_CHECKING:
    from kinesic.face.gl.context import GlContext

FACE_PACKAGES = {"scipy": "scipy", "PIL": "Pillow"}  # import name -> name of a package that every picture needs
INSTALL_DRIVER = "apt-get install libegl1 libgl1"  # command that installs OpenGL on Debian and Ubuntu


class DisplayError(RuntimeError):
    """Failure to draw a face, with the reason and the remedy.

    OpenGL or a file is missing, or an argument is invalid.
    """


@contextmanager
def open_offscreen_context() -> "Iterator[GlContext]":
    """Open an EGL context without a screen, released at the end.

    Neither a display nor a graphics card is needed.

    Raises:
        DisplayError: there is no OpenGL driver, or a package is missing.
    """
    if problem := explain_missing_packages():
        raise DisplayError(problem)
    from kinesic.egl import GraphicsError  # noqa: PLC0415 - as above
    from kinesic.face.gl.offscreen import open_context  # noqa: PLC0415 - only pictures need it

    try:
        context = open_context()
    except GraphicsError as error:
        raise DisplayError(f"no OpenGL: {error}; {INSTALL_DRIVER}") from None
    try:
        yield context
    finally:
        context.release()


def explain_missing_packages() -> str | None:
    """Return an error message about missing SciPy or Pillow, or None.

    SciPy builds the meshes, Pillow paints the skin.
    """
    missing = [name for module, name in FACE_PACKAGES.items() if find_spec(module) is None]
    return f"{missing[0]} is not installed: {install_extra('face')}" if missing else None


def find_display_problem() -> str | None:
    """Return the reason that prevents drawing here, or None."""
    try:
        with open_offscreen_context():
            return None
    except DisplayError as error:
        return str(error)
