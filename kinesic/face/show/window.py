"""Window that shows pictures of the face and receives keys."""

import os
import platform
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.extras import install_extra
from kinesic.face.display import DisplayError
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.programs import VertexColumn
from kinesic.face.gl.textures import Texture

if TYPE_CHECKING:
    import glfw


KEY_NAMES = ("left", "right", "up", "down", "escape", "comma", "period", *"0123wvq")
BACKGROUND_COLOUR = (0.055, 0.075, 0.105)  # linear RGB colour behind the picture
# Vertex shader that fills the viewport with a picture, whose first row is at the top.
_VERTEX_SHADER = """
#version 330
in vec2 corner;
out vec2 place;
void main() { place = vec2(corner.x, 1.0 - corner.y); gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0); }
"""
# Fragment shader that copies the colours of the picture.
_FRAGMENT_SHADER = """
#version 330
uniform sampler2D picture;
in vec2 place;
out vec4 colour;
void main() { colour = texture(picture, place); }
"""


def has_display() -> bool:
    """Return whether a window can probably be opened on this machine."""
    return platform.system() != "Linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


class Window:
    """On-screen window for pictures and keys, created by `open_window`."""

    def __init__(self, handle: "glfw._GLFWwindowPointerT", context: GlContext) -> None:
        import glfw  # noqa: PLC0415 - optional; `open_window` has imported it

        self._glfw, self._handle, self.context = glfw, handle, context
        self._keys: list[str] = []
        names = {getattr(glfw, f"KEY_{name.upper()}"): name for name in KEY_NAMES}

        def note_key(_window: object, key: int, _scan: int, action: int, _mods: int) -> None:
            if action != glfw.RELEASE and key in names:
                self._keys.append(names[key])

        glfw.set_key_callback(handle, note_key)
        shader = context.program(_VERTEX_SHADER, _FRAGMENT_SHADER)
        corners = context.buffer(np.array([0, 0, 1, 0, 0, 1, 1, 1], dtype="f4").tobytes())
        self._quad = context.vertices(shader, [VertexColumn("corner", corners, 2, 0, 2)])
        self._texture: Texture | None = None

    @property
    def closed(self) -> bool:
        """Whether the window was closed."""
        return bool(self._glfw.window_should_close(self._handle))

    def show(self, pixels: Picture, title: str) -> None:
        """Show a picture of the face, scaled to fit the window."""
        height, width, _ = pixels.shape
        if self._texture is None or self._texture.size != (width, height):
            self._texture = self.context.texture((width, height), 3)
        self._texture.write(pixels.tobytes())
        wide, tall = self._glfw.get_framebuffer_size(self._handle)
        scale = min(wide / width, tall / height)
        room = (round(scale * width), round(scale * height))
        self.context.clear_screen(*BACKGROUND_COLOUR)
        self.context.use_screen(((wide - room[0]) // 2, (tall - room[1]) // 2, *room))
        self._texture.use()
        self._quad.render(gl.GL_TRIANGLE_STRIP)
        self._glfw.swap_buffers(self._handle)
        self._glfw.set_window_title(self._handle, title)

    def pressed(self) -> list[str]:
        """Return the names of the keys pressed since the last call."""
        self._glfw.poll_events()
        keys, self._keys = self._keys, []
        return keys


class _WindowContext:
    """Owner of the OpenGL context of a window."""

    def __init__(self, handle: "glfw._GLFWwindowPointerT") -> None:
        import glfw  # noqa: PLC0415 - optional; `open_window` has imported it

        self._glfw, self._handle = glfw, handle

    def find(self, name: str) -> int:
        """Return the address of an OpenGL function, 0 if unknown."""
        address = self._glfw.get_proc_address(name)
        return address if isinstance(address, int) else int(address.value or 0) if address else 0

    def release(self) -> None:
        """Do nothing, since glfw frees the window's context."""

    def enter(self) -> None:
        """Make the window's OpenGL context current."""
        self._glfw.make_context_current(self._handle)

    def leave(self) -> None:
        """Do nothing, since the process has no other OpenGL context."""


@contextmanager
def open_window(size: tuple[int, int], title: str) -> Iterator[Window]:
    """Open a window in the main thread, closed at the end.

    Args:
        size: (width, height) [pixels].
        title: initial title.

    Raises:
        DisplayError: glfw is not installed, or no window can be opened here.
    """
    try:
        import glfw  # noqa: PLC0415 - optional
    except ImportError:
        raise DisplayError(f"glfw is not installed: {install_extra('face')}") from None
    faults: list[str] = []

    def note(_code: int, text: bytes | str) -> None:
        faults.append(text if isinstance(text, str) else text.decode(errors="replace"))

    glfw.set_error_callback(note)
    with ExitStack() as opened:
        if not glfw.init():
            raise DisplayError(_describe_failure(faults))
        opened.callback(glfw.terminate)
        for hint, value in (
            (glfw.CONTEXT_VERSION_MAJOR, 3),
            (glfw.CONTEXT_VERSION_MINOR, 3),
            (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
            (glfw.OPENGL_FORWARD_COMPAT, True),
        ):
            glfw.window_hint(hint, value)
        handle = glfw.create_window(*size, title, None, None)
        if not handle:
            raise DisplayError(_describe_failure(faults))
        glfw.make_context_current(handle)
        current = _WindowContext(handle)
        yield Window(handle, GlContext(current.find, current))


def _describe_failure(faults: list[str]) -> str:
    why = " ".join(faults[-1].split()) if faults else "for an unknown reason"
    return f"no window: {why}; on a machine without a display write to a file with --out"
