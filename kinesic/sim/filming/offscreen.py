"""OpenGL context without a window in which MuJoCo draws.

On Linux, EGL opens it, without a Python library. On other systems, MuJoCo opens it with PyOpenGL.
"""

import os
import platform
from ctypes import CFUNCTYPE, c_int, c_uint, c_void_p
from types import TracebackType
from typing import Protocol

import mujoco

from kinesic.body.arrays import Picture
from kinesic.egl import GraphicsError, start_egl
from kinesic.sim.gl import is_switched_off

GL_RGBA = 0x1908  # OpenGL pixel format of four colour channels, as in gl.h
GL_UNSIGNED_BYTE = 0x1401  # OpenGL data type of one byte per channel, as in gl.h
SWITCHED_OFF_MESSAGE = "drawing is switched off by MUJOCO_GL"
_ReadPixels = CFUNCTYPE(None, c_int, c_int, c_int, c_int, c_uint, c_uint, c_void_p)


class OffscreenError(RuntimeError):
    """Error raised if OpenGL cannot draw in this process."""


class _Owner(Protocol):
    """Owner of an OpenGL context that is current from its creation on."""

    def read(self, picture: Picture) -> None:
        """Copy the frame's lower left pixels into an RGBA picture."""

    def free(self) -> None:
        """Free the OpenGL context."""


class Offscreen:
    """OpenGL context and MuJoCo's resources for pictures of one model.

    A context manager, because both hold memory of the graphics card.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        size: tuple[int, int],
        font_scale: mujoco.mjtFontScale = mujoco.mjtFontScale.mjFONTSCALE_100,
    ) -> None:
        """Open the context, make it current, and upload the model.

        Args:
            model: model whose off-screen buffer is as large as the pictures.
            size: width and height of the pictures [pixels].
            font_scale: size of labels.

        Raises:
            OffscreenError: OpenGL does not draw.
        """
        try:
            self._owner: _Owner = _EglOwner() if platform.system() == "Linux" else _MujocoOwner(size)
            self.context = mujoco.MjrContext(model, font_scale.value)
        except (GraphicsError, mujoco.FatalError, RuntimeError, AttributeError, ImportError) as error:
            raise OffscreenError(str(error)) from None
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self.context)

    def read(self, picture: Picture) -> None:
        """Copy the frame's lower left pixels into a picture, lowest row first."""
        self._owner.read(picture)

    def __enter__(self) -> "Offscreen":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free MuJoCo's resources and the OpenGL context."""
        self.context.free()
        self._owner.free()


class _EglOwner:
    """OpenGL context created by EGL."""

    def __init__(self) -> None:
        if is_switched_off(os.environ):
            raise GraphicsError(SWITCHED_OFF_MESSAGE)
        self._egl = start_egl()
        self._context = self._egl.create_for_mujoco()
        self._egl.enter(self._context)
        self._read_pixels = _ReadPixels(self._egl.find("glReadPixels"))

    def read(self, picture: Picture) -> None:
        height, width, _ = picture.shape
        self._read_pixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, picture.ctypes.data)

    def free(self) -> None:
        self._egl.destroy(self._context)


class _MujocoOwner:
    """OpenGL context created by MuJoCo's Python package."""

    def __init__(self, size: tuple[int, int]) -> None:
        self._gl = mujoco.GLContext(*size)
        self._gl.make_current()
        from OpenGL.raw.GL.VERSION.GL_1_0 import glReadPixels  # noqa: PLC0415 - missing on Linux

        self._read_pixels = glReadPixels

    def read(self, picture: Picture) -> None:
        height, width, _ = picture.shape
        self._read_pixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, picture)

    def free(self) -> None:
        self._gl.free()
