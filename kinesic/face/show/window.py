"""A window on a display, in which pictures of the face are shown and keys are heard."""

import os
import platform
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

import numpy as np

from kinesic.face.display import INSTALL_LIBRARY, DisplayError, library

if TYPE_CHECKING:
    import glfw
    import moderngl

    from kinesic.face.render.portrait import Pixels

KEYS = ("left", "right", "up", "down", "escape", "comma", "period", *"0123wvq")
GROUND = (0.055, 0.075, 0.105)
_VERTEX = """
#version 330
in vec2 corner;
out vec2 place;
void main() { place = vec2(corner.x, 1.0 - corner.y); gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0); }
"""
_FRAGMENT = """
#version 330
uniform sampler2D picture;
in vec2 place;
out vec4 colour;
void main() { colour = texture(picture, place); }
"""


def has_display() -> bool:
    """Whether windows can be expected to open here."""
    return platform.system() != "Linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


class Window:
    """An open window; made by `open_window`."""

    def __init__(self, handle: "glfw._GLFWwindowPointerT", context: "moderngl.Context") -> None:
        import glfw  # noqa: PLC0415 - optional; `open_window` has imported it

        self._glfw, self._handle, self.context = glfw, handle, context
        self._keys: list[str] = []
        names = {getattr(glfw, f"KEY_{name.upper()}"): name for name in KEYS}

        def note_key(_window: object, key: int, _scan: int, action: int, _mods: int) -> None:
            if action != glfw.RELEASE and key in names:
                self._keys.append(names[key])

        glfw.set_key_callback(handle, note_key)
        shader = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        corners = np.array([0, 0, 1, 0, 0, 1, 1, 1], dtype="f4")
        self._quad = context.vertex_array(shader, [(context.buffer(corners.tobytes()), "2f", "corner")])
        self._texture: moderngl.Texture | None = None

    @property
    def closed(self) -> bool:
        """Whether somebody closed it."""
        return bool(self._glfw.window_should_close(self._handle))

    def show(self, pixels: "Pixels", title: str) -> None:
        """Shows a picture, as large as the window has room for."""
        height, width, _ = pixels.shape
        if self._texture is None or self._texture.size != (width, height):
            self._texture = self.context.texture((width, height), 3, alignment=1)
        self._texture.write(pixels.tobytes())
        wide, tall = self._glfw.get_framebuffer_size(self._handle)
        scale = min(wide / width, tall / height)
        room = (round(scale * width), round(scale * height))
        self.context.screen.use()
        self.context.disable(self.context.DEPTH_TEST | self.context.CULL_FACE)
        self.context.viewport = (0, 0, wide, tall)
        self.context.clear(*GROUND)
        self.context.viewport = ((wide - room[0]) // 2, (tall - room[1]) // 2, *room)
        self._texture.use()
        self._quad.render(self.context.TRIANGLE_STRIP)
        self._glfw.swap_buffers(self._handle)
        self._glfw.set_window_title(self._handle, title)

    def pressed(self) -> list[str]:
        """Names of the keys that were pressed since the last call."""
        self._glfw.poll_events()
        keys, self._keys = self._keys, []
        return keys


class _Current:
    """The context of a window, however the window system made it, as moderngl wants it."""

    def __init__(self, handle: "glfw._GLFWwindowPointerT") -> None:
        import glfw  # noqa: PLC0415 - optional; `open_window` has imported it

        self._glfw, self._handle = glfw, handle

    def load(self, name: str) -> int:
        """Address of a function of OpenGL, 0 for an unknown one."""
        found = self._glfw.get_proc_address(name)
        return found if isinstance(found, int) else int(found.value or 0) if found else 0

    def release(self) -> None:
        """The window goes with glfw."""

    def __enter__(self) -> None:
        self._glfw.make_context_current(self._handle)

    def __exit__(self, *_: object) -> None:
        pass


@contextmanager
def open_window(size: tuple[int, int], title: str) -> Iterator[Window]:
    """Opens a window, and closes it at the end; of the main thread of a process.

    Args:
        size: (width, height) [pixels].
        title: that it has at first.

    Raises:
        DisplayError: glfw or moderngl is not installed, or no window opens here.
    """
    try:
        import glfw  # noqa: PLC0415 - optional
    except ImportError:
        raise DisplayError(f"glfw is not installed; {INSTALL_LIBRARY}") from None
    moderngl = library()
    faults: list[str] = []

    def note(_code: int, text: bytes | str) -> None:
        faults.append(text if isinstance(text, str) else text.decode(errors="replace"))

    glfw.set_error_callback(note)
    with ExitStack() as opened:
        if not glfw.init():
            raise DisplayError(_no_window(faults))
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
            raise DisplayError(_no_window(faults))
        glfw.make_context_current(handle)
        yield Window(handle, moderngl.create_context(context=_Current(handle)))


def _no_window(faults: list[str]) -> str:
    why = " ".join(faults[-1].split()) if faults else "for an unknown reason"
    return f"no window: {why}; on a machine without a display write to a file with --out"
