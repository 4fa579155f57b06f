"""Draws a model off screen, all of a picture or a part of it, as often as it is asked."""

from types import TracebackType
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinesic.body.arrays import Picture
from kinesic.files.film_file import PixelBox
from kinesic.sim.filming.drawn_face import SCREEN
from kinesic.sim.filming.scene_screen import has_screen, put_face
from kinesic.sim.scene_style import CAMERA, FLOOR_GROUP

MOST_SHAPES = 4000  # that are drawn at once
RGBA, BYTES = 0x1908, 0x1401  # of gl.h
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
            from OpenGL.raw.GL.VERSION.GL_1_0 import glReadPixels  # noqa: PLC0415 - looks for OpenGL, which may not be
        except (mujoco.FatalError, RuntimeError, AttributeError, ImportError) as error:
            raise CanvasError(EARLY.format(error)) from None
        self._read_pixels = glReadPixels
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._scene = mujoco.MjvScene(model=model, maxgeom=MOST_SHAPES)
        self._robot, self._room, self._camera = mujoco.MjvOption(), mujoco.MjvOption(), mujoco.MjvCamera()
        self._robot.geomgroup[FLOOR_GROUP] = 0
        self._room.geomgroup[:] = np.arange(len(self._room.geomgroup)) == FLOOR_GROUP
        self._camera.type, self._camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(CAMERA).id
        self._drawn = np.empty(4 * width * height, dtype=np.uint8)  # memory that is asked for anew costs more
        self._floor: NDArray[np.float32] | None = None
        self._screened = has_screen(model)

    def show(self, picture: Picture) -> None:
        """Puts a picture on the screen of the head, if there is one."""
        if self._screened:
            if picture.shape[:2] != SCREEN[::-1]:
                picture = np.asarray(Image.fromarray(picture).resize(SCREEN, Image.Resampling.BILINEAR))
            mujoco.mjr_uploadTexture(self._model, self._context, put_face(self._model, picture))

    def draw(self, data: mujoco.MjData, box: PixelBox | None = None, *, sunk: PixelBox | None = None) -> Image.Image:
        """Draws the robot alone, before nothing: floor and sky, which stay, would take longer than it.

        Args:
            data: its posture.
            box: the part of the picture that is drawn; None: all.
            sunk: the part of the picture in which the floor may hide something of it; None: nowhere.

        Returns:
            The part as RGBa: colours weighted with how much of each pixel is the robot.
        """
        box = box or (0, 0, *self._size)
        common = None if sunk is None else _common(box, sunk)
        floor = None if common is None else self._floor_depths(data)
        self._render(data, self._robot, box)
        drawn = self._pixels(box)
        if common is not None and floor is not None:
            there, here = self._area((0, 0, *self._size), common), self._area(box, common)
            hidden = self._depths(here) >= floor[_part(there)]
            drawn[_part(here)][hidden] = 0
        return self._reduced(drawn, "RGBa")

    def draw_empty(self, data: mujoco.MjData) -> Image.Image:
        """Draws a picture without the robot, RGB."""
        whole = (0, 0, *self._size)
        self._render(data, self._room, whole)
        return self._reduced(self._pixels(whole), "RGBX").convert("RGB")

    def _floor_depths(self, data: mujoco.MjData) -> NDArray[np.float32]:
        """How far the floor is at each pixel of the whole picture."""
        if self._floor is None:
            whole = (0, 0, *self._size)
            self._render(data, self._room, whole)
            self._floor = self._depths(self._area(whole, whole))
        return self._floor

    def _reduced(self, drawn: Picture, mode: Literal["RGBa", "RGBX"]) -> Image.Image:
        """From the rows and pixels of OpenGL to those of pictures."""
        fine = Image.frombuffer("RGBX", (drawn.shape[1], drawn.shape[0]), drawn, "raw", "RGBX", 0, 1)
        coarse = fine.reduce(self._finer)
        return Image.frombytes(mode, coarse.size, coarse.tobytes(), "raw", mode, 0, -1)

    def _render(self, data: mujoco.MjData, option: mujoco.MjvOption, box: PixelBox) -> None:
        (width, height), (left, top, right, low) = self._size, box
        mujoco.mjv_updateScene(
            self._model, data, option, None, self._camera, mujoco.mjtCatBit.mjCAT_ALL.value, self._scene
        )
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX.value] = option is self._room
        for camera in self._scene.camera:
            _narrow(camera, (left / width, top / height, right / width, low / height), width / height)
        mujoco.mjr_render(self._area(box, box), self._scene, self._context)

    def _area(self, box: PixelBox, part: PixelBox) -> mujoco.MjrRect:
        """Where OpenGL has a part of a box that is drawn; its first row is the lowest."""
        finer = self._finer
        (left, _, _, low), (begin, top, end, foot) = box, part
        return mujoco.MjrRect(finer * (begin - left), finer * (low - foot), finer * (end - begin), finer * (foot - top))

    def _pixels(self, box: PixelBox) -> Picture:
        """(h, w, 4) what was drawn in a box, the fourth 255 where anything was; the next picture takes its place."""
        area = self._area(box, box)
        drawn = self._drawn[: 4 * area.height * area.width].reshape(area.height, area.width, 4)
        self._read_pixels(0, 0, area.width, area.height, RGBA, BYTES, drawn)
        return drawn

    def _depths(self, area: mujoco.MjrRect) -> NDArray[np.float32]:
        near = np.empty((area.height, area.width), dtype=np.float32)
        mujoco.mjr_readPixels(None, near, area, self._context)
        return near

    def __enter__(self) -> "Canvas":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._context.free()
        self._gl.free()


def _common(one: PixelBox, other: PixelBox) -> PixelBox | None:
    """Intersects two boxes; None where they have nothing in common."""
    left, top, right, low = max(one[0], other[0]), max(one[1], other[1]), min(one[2], other[2]), min(one[3], other[3])
    return (left, top, right, low) if left < right and top < low else None


def _part(area: mujoco.MjrRect) -> tuple[slice, slice]:
    return slice(area.bottom, area.bottom + area.height), slice(area.left, area.left + area.width)


def _narrow(camera: mujoco.MjvGLCamera, shares: tuple[float, float, float, float], aspect: float) -> None:
    """Lets a camera see a part of its picture: left, top, right and bottom as shares of it."""
    left, top, right, low = shares
    tall, upper = camera.frustum_top - camera.frustum_bottom, camera.frustum_top
    wide = tall * aspect
    camera.frustum_center = wide * ((left + right) / 2 - 0.5)
    camera.frustum_width = wide * (right - left) / 2
    camera.frustum_top, camera.frustum_bottom = upper - top * tall, upper - low * tall
