"""Off-screen pictures of a MuJoCo model from any camera."""

from types import TracebackType

import mujoco
import numpy as np

from kinesic.body.arrays import Picture
from kinesic.sim.filming.offscreen import Offscreen
from kinesic.sim.filming.scene_screen import upload_face

MAX_SCENE_GEOMS = 10_000  # largest number of geoms in a MuJoCo scene


class SceneRenderer:
    """Renderer of a whole model in RGB, one picture after the other."""

    def __init__(self, model: mujoco.MjModel, size: tuple[int, int]) -> None:
        """Open an OpenGL context for pictures of one size [pixels].

        Raises:
            OffscreenError: OpenGL does not draw.
        """
        self._model, self._offscreen = model, Offscreen(model, size)
        self._area = mujoco.MjrRect(0, 0, *size)
        self._scene, self._option = mujoco.MjvScene(model=model, maxgeom=MAX_SCENE_GEOMS), mujoco.MjvOption()

    def show(self, face: Picture) -> None:
        """Upload a picture to the face screen, if the model has one."""
        upload_face(self._model, self._offscreen.context, face)

    def draw(self, data: mujoco.MjData, camera: mujoco.MjvCamera) -> Picture:
        """Draw a posture as a camera sees it, (h, w, 3)."""
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(self._model, data, self._option, None, camera, everything, self._scene)
        mujoco.mjr_render(self._area, self._scene, self._offscreen.context)
        picture = np.empty((self._area.height, self._area.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(picture, None, self._area, self._offscreen.context)
        return picture[::-1].copy()  # row 0 of OpenGL is the lowest

    def __enter__(self) -> "SceneRenderer":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._offscreen.close()
