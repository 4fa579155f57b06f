"""Off-screen OpenGL rendering of a MuJoCo model, in whole pictures or regions."""

from types import TracebackType
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Picture
from kinesic.files.film_file import PixelBox
from kinesic.files.late_pillow import Image
from kinesic.sim.filming.offscreen import Offscreen, OffscreenError
from kinesic.sim.filming.scene_screen import upload_face
from kinesic.sim.scene_style import CAMERA_NAME, FLOOR_GROUP

MAX_SCENE_GEOMS = 4000  # largest number of geoms in a MuJoCo scene
DRAWING_ERROR_MESSAGE = "MuJoCo cannot draw ({}): `kinesic doctor` shows what is missing"


class CanvasError(RuntimeError):
    """Error raised if OpenGL cannot draw in this process."""


class Canvas:
    """Off-screen renderer of the camera view of a model.

    A context manager, because the renderer holds memory of the graphics card.
    """

    def __init__(self, model: mujoco.MjModel, size: tuple[int, int], *, supersampling: int = 1) -> None:
        """Create the OpenGL context and the buffers for pictures of one size.

        Args:
            model: Result of `styled_model` for pictures of at least `supersampling` times the size.
            size: Width and height of the whole picture [pixels].
            supersampling: Rendered pixels per picture pixel along each side.

        Raises:
            CanvasError: OpenGL does not draw.
        """
        self._model, self._size, self._finer = model, size, supersampling
        width, height = (supersampling * side for side in size)
        try:
            self._offscreen = Offscreen(model, (width, height))
        except OffscreenError as error:
            raise CanvasError(DRAWING_ERROR_MESSAGE.format(error)) from None
        self._context = self._offscreen.context
        self._scene = mujoco.MjvScene(model=model, maxgeom=MAX_SCENE_GEOMS)
        self._robot, self._room, self._camera = mujoco.MjvOption(), mujoco.MjvOption(), mujoco.MjvCamera()
        self._robot.geomgroup[FLOOR_GROUP] = 0
        self._room.geomgroup[:] = np.arange(len(self._room.geomgroup)) == FLOOR_GROUP
        self._camera.type, self._camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(CAMERA_NAME).id
        self._drawn = np.empty(
            4 * width * height, dtype=np.uint8
        )  # reused buffer: a new allocation per picture is slower
        self._floor: NDArray[np.float32] | None = None

    def show(self, picture: Picture) -> None:
        """Upload a picture to the face screen, if the model has one."""
        upload_face(self._model, self._context, picture)

    def draw(self, data: mujoco.MjData, box: PixelBox | None = None, *, sunk: PixelBox | None = None) -> "Image.Image":
        """Draw only the robot, on a transparent background.

        Floor and sky do not change and would take longer to draw than the robot.

        Args:
            data: MuJoCo data with the posture.
            box: Region of the picture that is drawn; None: all.
            sunk: Region of the picture in which the floor may hide parts of the robot; None: nowhere.

        Returns:
            The region as RGBa: colours premultiplied with the coverage of each pixel by the robot.
        """
        box = box or (0, 0, *self._size)
        overlap = None if sunk is None else _intersect(box, sunk)
        floor = None if overlap is None else self._read_floor_depths(data)
        self._render(data, self._robot, box)
        drawn = self._read_box(box)
        if overlap is not None and floor is not None:
            floor_area, drawn_area = self._find_area((0, 0, *self._size), overlap), self._find_area(box, overlap)
            hidden = self._read_depths(drawn_area) >= floor[_crop(floor_area)]
            drawn[_crop(drawn_area)][hidden] = 0
        return self._downsample(drawn, "RGBa")

    def draw_empty(self, data: mujoco.MjData) -> "Image.Image":
        """Draw the scene without the robot, in RGB."""
        whole = (0, 0, *self._size)
        self._render(data, self._room, whole)
        return self._downsample(self._read_box(whole), "RGBX").convert("RGB")

    def _read_floor_depths(self, data: mujoco.MjData) -> NDArray[np.float32]:
        """Return the depth buffer of the floor for the whole picture."""
        if self._floor is None:
            whole = (0, 0, *self._size)
            self._render(data, self._room, whole)
            self._floor = self._read_depths(self._find_area(whole, whole))
        return self._floor

    def _downsample(self, drawn: Picture, mode: Literal["RGBa", "RGBX"]) -> "Image.Image":
        """Downsample a buffer of OpenGL and flip its rows into a picture."""
        fine = Image.frombuffer("RGBX", (drawn.shape[1], drawn.shape[0]), drawn, "raw", "RGBX", 0, 1)
        coarse = fine.reduce(self._finer)
        return Image.frombytes(mode, coarse.size, coarse.tobytes(), "raw", mode, 0, -1)

    def _render(self, data: mujoco.MjData, option: mujoco.MjvOption, box: PixelBox) -> None:
        (width, height), (left, top, right, bottom) = self._size, box
        mujoco.mjv_updateScene(
            self._model, data, option, None, self._camera, mujoco.mjtCatBit.mjCAT_ALL.value, self._scene
        )
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX.value] = option is self._room
        for camera in self._scene.camera:
            _narrow_frustum(camera, (left / width, top / height, right / width, bottom / height), width / height)
        mujoco.mjr_render(self._find_area(box, box), self._scene, self._context)

    def _find_area(self, box: PixelBox, part: PixelBox) -> mujoco.MjrRect:
        """Convert part of a rendered picture region to an OpenGL rectangle.

        The rectangle is in supersampled pixels from the lower left corner of the rendered region.
        """
        supersampling = self._finer
        (left, _, _, bottom), (begin, top, end, foot) = box, part
        return mujoco.MjrRect(
            supersampling * (begin - left),
            supersampling * (bottom - foot),
            supersampling * (end - begin),
            supersampling * (foot - top),
        )

    def _read_box(self, box: PixelBox) -> Picture:
        """Read the rendered pixels (h, w, 4) of a picture region.

        The fourth channel is 255 where anything was drawn. The next picture overwrites the buffer.
        """
        area = self._find_area(box, box)
        drawn = self._drawn[: 4 * area.height * area.width].reshape(area.height, area.width, 4)
        self._offscreen.read(drawn)
        return drawn

    def _read_depths(self, area: mujoco.MjrRect) -> NDArray[np.float32]:
        near = np.empty((area.height, area.width), dtype=np.float32)
        mujoco.mjr_readPixels(None, near, area, self._context)
        return near

    def __enter__(self) -> "Canvas":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._offscreen.close()


def _intersect(one: PixelBox, other: PixelBox) -> PixelBox | None:
    """Return the intersection of two boxes, or None without overlap."""
    left, top, right, bottom = (
        max(one[0], other[0]),
        max(one[1], other[1]),
        min(one[2], other[2]),
        min(one[3], other[3]),
    )
    return (left, top, right, bottom) if left < right and top < bottom else None


def _crop(area: mujoco.MjrRect) -> tuple[slice, slice]:
    return slice(area.bottom, area.bottom + area.height), slice(area.left, area.left + area.width)


def _narrow_frustum(camera: mujoco.MjvGLCamera, region: tuple[float, float, float, float], aspect: float) -> None:
    """Restrict the frustum of a camera to a region of its picture.

    Args:
        camera: Camera that is changed.
        region: Left, top, right and bottom edge as fractions of the picture.
        aspect: Width / height of the whole picture.
    """
    left, top, right, bottom = region
    full_height, full_top = camera.frustum_top - camera.frustum_bottom, camera.frustum_top
    full_width = full_height * aspect
    camera.frustum_center = full_width * ((left + right) / 2 - 0.5)
    camera.frustum_width = full_width * (right - left) / 2
    camera.frustum_top, camera.frustum_bottom = full_top - top * full_height, full_top - bottom * full_height
