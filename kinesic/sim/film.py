"""Moving and still pictures of the robot, drawn off screen."""

from collections.abc import Callable, Iterator
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.sim.gl import missing_libraries, opengl_fault
from kinesic.sim.model import turn_order
from kinesic.sim.scene_style import CAMERA, styled_model

__all__ = ["FilmError", "film", "opengl_fault", "write_still"]

Picture = NDArray[np.uint8]
SIZE = (480, 360)  # [pixels] width and height of a still
FILM_SIZE = (320, 240)
FINER = 1.5  # pixels that are drawn along a side of one in a film; without a card, that is cheaper than multisampling
FILM_SHADOW = 1024  # pixels along a side of its shadows
FILM_ROUND = (16, 8)  # slices and stacks of its capsules
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
    size: tuple[int, int] = FILM_SIZE,
    rate: float = 20.0,
    progress: Callable[[float], None] = lambda share: None,
    guarded: bool = True,
) -> None:
    """Writes a motion as an animated WebP.

    Args:
        robot: who moves.
        times: (m,) [s] increasing.
        angles: (m, n) [rad] at these times.
        path: of the film, ending in .webp.
        size: width and height of a picture, in pixels.
        rate: pictures per second; less when there would be more than MOST_PICTURES.
        progress: gets the share of the pictures that are drawn, after each of them.
        guarded: whether OpenGL is first tried in another process, as a broken driver may end the one that draws.

    Raises:
        FilmError: OpenGL does not draw on this machine.
        ValueError: there is no posture, or times and angles differ in number.
    """
    if len(times) != len(angles) or not len(times):
        raise ValueError(f"a film of {len(angles)} postures at {len(times)} times: both must be the same, at least 1")
    period = max(1 / rate, (times[-1] - times[0]) / MOST_PICTURES)
    moments = np.arange(times[0], times[-1] + 1e-9, period)
    postures = np.column_stack([np.interp(moments, times, column) for column in angles.T])
    frames = []
    for picture in _draw_frames(robot, postures, size, guarded=guarded):
        frames.append(Image.fromarray(picture).resize(size, Image.Resampling.LANCZOS))
        progress(len(frames) / len(postures))
    durations = np.diff(np.round(1000 * period * np.arange(len(frames) + 1))).astype(int).tolist()  # [ms]
    frames[0].save(
        path, format="WEBP", save_all=True, append_images=frames[1:], duration=durations, quality=QUALITY, method=0
    )


def write_still(robot: Robot, angles: Floats, path: Path, *, size: tuple[int, int] = SIZE) -> None:
    """Writes one posture (n,) [rad] as a PNG.

    Raises:
        FilmError: OpenGL does not draw on this machine.
    """
    _check_opengl(guarded=True)
    model = styled_model(robot, width=size[0], height=size[1])
    Image.fromarray(next(_pictures(robot, model, angles[None], size))).save(path, format="PNG")


def _draw_frames(robot: Robot, postures: Floats, size: tuple[int, int], *, guarded: bool) -> Iterator[Picture]:
    """Draws postures (m, n) [rad] with what a film needs, each `FINER` than it is shown."""
    _check_opengl(guarded=guarded)
    width, height = (round(FINER * side) for side in size)
    model = styled_model(robot, width=width, height=height)
    model.vis.quality.offsamples, model.vis.quality.shadowsize = 0, FILM_SHADOW
    model.vis.quality.numslices, model.vis.quality.numstacks = FILM_ROUND
    yield from _pictures(robot, model, postures, (width, height))


def _check_opengl(*, guarded: bool) -> None:
    if why := opengl_fault() if guarded else missing_libraries():
        raise FilmError(why)


def _pictures(robot: Robot, model: mujoco.MjModel, postures: Floats, size: tuple[int, int]) -> Iterator[Picture]:
    """Yields one picture (height, width, 3) for each posture (m, n) [rad]."""
    width, height = size
    data = mujoco.MjData(model)
    order = turn_order(robot, model)
    with _renderer(model, width, height) as renderer:
        for posture in postures:
            data.qpos[order] = robot.skeleton.turns(posture)
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera=CAMERA)
            yield renderer.render().copy()


def _renderer(model: mujoco.MjModel, width: int, height: int) -> mujoco.Renderer:
    try:
        return mujoco.Renderer(model, height, width)
    except (mujoco.FatalError, RuntimeError) as error:
        raise FilmError(
            f"MuJoCo cannot draw ({error}): import kinesic.sim before mujoco, or set MUJOCO_GL=egl"
        ) from None
