"""Moving and still pictures of the robot, drawn off screen."""

from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.sim.gl import opengl_fault
from kinesic.sim.model import joint_order
from kinesic.sim.scene_style import CAMERA, styled_model

__all__ = ["FilmError", "film", "opengl_fault", "write_still"]

Picture = NDArray[np.uint8]
SIZE = (480, 360)  # [pixels] width and height of a picture
QUALITY = 80  # of WebP, 0..100
MOST_PICTURES = 600  # they are held in memory until the file is written


class FilmError(RuntimeError):
    """Pictures cannot be drawn here: says what is missing and the line that mends it."""


def film(
    robot: Robot,
    times: Floats,
    angles: Floats,
    path: Path,
    *,
    size: tuple[int, int] = SIZE,
    rate: float = 20.0,
) -> None:
    """Writes a motion as an animated WebP.

    Args:
        robot: who moves.
        times: (m,) [s] increasing.
        angles: (m, n) [rad] at these times.
        path: of the film, ending in .webp.
        size: width and height of a picture, in pixels.
        rate: pictures per second; less when there would be more than MOST_PICTURES.

    Raises:
        FilmError: OpenGL does not draw on this machine.
        ValueError: there is no posture, or times and angles differ in number.
    """
    if len(times) != len(angles) or not len(times):
        raise ValueError(f"a film of {len(angles)} postures at {len(times)} times: both must be the same, at least 1")
    period = max(1 / rate, (times[-1] - times[0]) / MOST_PICTURES)
    moments = np.arange(times[0], times[-1] + 1e-9, period)
    postures = np.column_stack([np.interp(moments, times, column) for column in angles.T])
    frames = [Image.fromarray(picture) for picture in _pictures(robot, postures, size)]
    durations = np.diff(np.round(1000 * period * np.arange(len(frames) + 1))).astype(int).tolist()  # [ms]
    frames[0].save(
        path, format="WEBP", save_all=True, append_images=frames[1:], duration=durations, quality=QUALITY, method=0
    )


def write_still(robot: Robot, angles: Floats, path: Path, *, size: tuple[int, int] = SIZE) -> None:
    """Writes one posture (n,) [rad] as a PNG.

    Raises:
        FilmError: OpenGL does not draw on this machine.
    """
    Image.fromarray(_pictures(robot, angles[None], size)[0]).save(path, format="PNG")


def _pictures(robot: Robot, postures: Floats, size: tuple[int, int]) -> list[Picture]:
    """One picture (height, width, 3) for each posture (m, n) [rad]."""
    if why := opengl_fault():
        raise FilmError(why)
    width, height = size
    model = styled_model(robot, width=width, height=height)
    data = mujoco.MjData(model)
    order = joint_order(robot, model)
    pictures = []
    with _renderer(model, width, height) as renderer:
        for posture in postures:
            data.qpos[order] = posture
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera=CAMERA)
            pictures.append(renderer.render().copy())
    return pictures


def _renderer(model: mujoco.MjModel, width: int, height: int) -> mujoco.Renderer:
    try:
        return mujoco.Renderer(model, height, width)
    except (mujoco.FatalError, RuntimeError) as error:
        raise FilmError(
            f"MuJoCo cannot draw ({error}): import kinesic.sim before mujoco, or set MUJOCO_GL=egl"
        ) from None
