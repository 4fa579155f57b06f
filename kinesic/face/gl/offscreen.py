"""OpenGL contexts of the face without a window, through EGL."""

from kinesic import egl
from kinesic.egl import Current, Egl
from kinesic.face.gl.context import GlContext


class _Offscreen:
    """OpenGL context without a window, owned by EGL."""

    def __init__(self, library: Egl) -> None:
        self._egl, self._before = library, list[Current]()
        self._context = library.create()
        library.enter(self._context)

    def enter(self) -> None:
        """Make the offscreen context current."""
        self._before.append(self._egl.current())
        self._egl.enter(self._context)

    def leave(self) -> None:
        """Make the previous OpenGL context current again."""
        self._egl.restore(self._before.pop())

    def release(self) -> None:
        """Free the offscreen context."""
        self._egl.destroy(self._context)


def open_context() -> GlContext:
    """Open an OpenGL context without a window and make it current.

    Raises:
        GraphicsError: nothing can be drawn here; the message says why.
    """
    library = egl.start_egl()
    return GlContext(library.find, _Offscreen(library))
