"""Draws a model off screen, all of a picture or a part of it, as often as it is asked."""

from types import TracebackType

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinesic.files.film_file import Box, Picture
from kinesic.sim.filming.drawn_face import SIZE
from kinesic.sim.filming.scene_screen import has_screen, put_face
from kinesic.sim.scene_style import CAMERA, FLOOR_GROUP

MOST_SHAPES = 4000  # that are drawn at once
NOTHING = 1.0  # the depth where nothing was drawn
EARLY = "MuJoCo cannot draw ({}): import kinesic.sim before mujoco, or set MUJOCO_GL=egl"


class CanvasError(RuntimeError):
    """Nothing can be drawn."""


class Canvas:
    """What the camera of a model sees; a context manager, as drawing needs memory of the graphics card."""

    def __init__(self, model: mujoco.MjModel, size: tuple[int, int], *, finer: int = 1) -> None:
        """Makes ready to draw.

        Args:
            model: of `styled_model`, whose largest picture is at least `finer` times the size.
            size: width and height of the whole picture [pixels].
            finer: pixels that are drawn along a side of one.

        Raises:
            CanvasError: OpenGL does not draw.
        """
        self._model, self._size, self._finer = model, size, finer
        width, height = (finer * side for side in size)
        try:
            self._gl = mujoco.GLContext(width, height)
            self._gl.make_current()
            self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        except (mujoco.FatalError, RuntimeError, AttributeError) as error:
            raise CanvasError(EARLY.format(error)) from None
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._scene = mujoco.MjvScene(model=model, maxgeom=MOST_SHAPES)
        self._robot, self._room, self._camera = mujoco.MjvOption(), mujoco.MjvOption(), mujoco.MjvCamera()
        self._robot.geomgroup[FLOOR_GROUP] = 0
        self._room.geomgroup[:] = np.arange(len(self._room.geomgroup)) == FLOOR_GROUP
        self._camera.type, self._camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(CAMERA).id
        self._empty: tuple[Picture, NDArray[np.float32]] | None = None
        self._screened = has_screen(model)

    def show(self, picture: Picture) -> None:
        """Puts a picture on the screen of the head, if there is one."""
        if self._screened:
            if picture.shape[:2] != SIZE[::-1]:
                picture = np.asarray(Image.fromarray(picture).resize(SIZE, Image.Resampling.BILINEAR))
            mujoco.mjr_uploadTexture(self._model, self._context, put_face(self._model, picture))

    def draw(self, data: mujoco.MjData, box: Box | None = None) -> tuple[Picture, Picture]:
        """Draws the robot alone, on black: floor and sky, which stay, would take longer than it.

        Args:
            data: its posture.
            box: the part of the picture that is drawn; None: all.

        Returns:
            (h, w, 3) the part, and (h, w) how much of each of its pixels is floor or sky, 0..255.
        """
        left, top, right, low = box = box or (0, 0, *self._size)
        drawn, near = self._draw(data, self._robot, box)
        upward, finer = self._size[1], self._finer
        rows, columns = slice(finer * (upward - low), finer * (upward - top)), slice(finer * left, finer * right)
        seen = near < self._drawn_empty(data)[1][rows, columns]
        if (below := (near < NOTHING) & ~seen).any():
            drawn[below] = 0  # it is behind the floor
        return self._reduced(drawn), np.uint8(255) - self._reduced(seen.view(np.uint8) * np.uint8(255))

    def draw_empty(self, data: mujoco.MjData) -> Picture:
        """Draws a picture without the robot."""
        return self._reduced(self._drawn_empty(data)[0])

    def _drawn_empty(self, data: mujoco.MjData) -> "tuple[Picture, NDArray[np.float32]]":
        if self._empty is None:
            self._empty = self._draw(data, self._room, (0, 0, *self._size))
        return self._empty

    def _reduced(self, drawn: Picture) -> Picture:
        """From the rows and pixels of OpenGL to those of pictures."""
        return np.asarray(Image.fromarray(drawn).reduce(self._finer))[::-1]

    def _draw(self, data: mujoco.MjData, option: mujoco.MjvOption, box: Box) -> tuple[Picture, NDArray[np.float32]]:
        """Colours, and how far the nearest thing is, as OpenGL has it: the first row is the lowest."""
        (width, height), (left, top, right, low) = self._size, box
        mujoco.mjv_updateScene(
            self._model, data, option, None, self._camera, mujoco.mjtCatBit.mjCAT_ALL.value, self._scene
        )
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX.value] = option is self._room
        for camera in self._scene.camera:
            _narrow(camera, (left / width, top / height, right / width, low / height), width / height)
        area = mujoco.MjrRect(0, 0, self._finer * (right - left), self._finer * (low - top))
        drawn = np.empty((area.height, area.width, 3), dtype=np.uint8)
        near = np.empty((area.height, area.width), dtype=np.float32)
        mujoco.mjr_render(area, self._scene, self._context)
        mujoco.mjr_readPixels(drawn, near, area, self._context)
        return drawn, near

    def __enter__(self) -> "Canvas":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._context.free()
        self._gl.free()


def _narrow(camera: mujoco.MjvGLCamera, shares: tuple[float, float, float, float], aspect: float) -> None:
    """Lets a camera see a part of its picture: left, top, right and bottom as shares of it."""
    left, top, right, low = shares
    tall, upper = camera.frustum_top - camera.frustum_bottom, camera.frustum_top
    wide = tall * aspect
    camera.frustum_center = wide * ((left + right) / 2 - 0.5)
    camera.frustum_width = wide * (right - left) / 2
    camera.frustum_top, camera.frustum_bottom = upper - top * tall, upper - low * tall
