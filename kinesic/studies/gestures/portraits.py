"""A robot in some postures, drawn with light and shade: by MuJoCo, or with its skin where it has one."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import radians
from types import MappingProxyType

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, Picture
from kinesic.body.robot import Robot
from kinesic.body.rotation import about
from kinesic.face.display import DisplayError
from kinesic.face.render.camera import Camera
from kinesic.face.render.figure import FigurePortrait
from kinesic.sim.film import FilmError, opengl_fault
from kinesic.sim.model import turn_order
from kinesic.sim.scene_style import styled_model
from kinesic.studies.gestures.framing import RISE, Balls, Viewpoint

Units = Mapping[str, float]
Draw = Callable[[Floats, Units, Viewpoint], Picture]
NEUTRAL: Units = MappingProxyType({})
ROUND, RATE = 96, 24.0  # pictures of a turntable, and how many are shown a second [Hz]
SIDE = 480  # [pixels] of each
SAMPLES = 4  # of a pixel


def draw_stills(
    robot: Robot, postures: Sequence[Floats], faces: Sequence[Units], size: tuple[int, int]
) -> tuple[Viewpoint, list[Picture]]:
    """Draws postures from the front, all from one place, and says from where.

    Args:
        robot: that is drawn.
        postures: (n,) [rad] each.
        faces: action units -> 0..1 of each, shown by a robot with skin.
        size: (width, height) of a picture [pixels].

    Raises:
        FilmError: OpenGL does not draw on this machine.
    """
    (view,) = Balls.of(robot, postures).viewpoints([0.0], size[0] / size[1], rise=_rise(robot))
    with _drawing(robot, size) as draw:
        return view, [draw(angles, units, view) for angles, units in zip(postures, faces, strict=True)]


def draw_round(
    robot: Robot, angles: Floats, units: Units = NEUTRAL, progress: Callable[[float], None] = lambda share: None
) -> list[Picture]:
    """Draws a posture from all around, beginning in front, with even steps and no end.

    Args:
        robot: that is drawn.
        angles: (n,) [rad].
        units: action units -> 0..1, shown by a robot with skin.
        progress: gets the share of the pictures that are drawn.

    Raises:
        FilmError: OpenGL does not draw on this machine.
    """
    yaws = [360.0 * k / ROUND for k in range(ROUND)]
    pictures = []
    with _drawing(robot, (SIDE, SIDE)) as draw:
        for view in Balls.of(robot, [angles]).viewpoints(yaws, 1.0, rise=_rise(robot)):
            pictures.append(draw(angles, units, view))
            progress(len(pictures) / ROUND)
    return pictures


def _rise(robot: Robot) -> float:
    """[deg] that the camera looks down; the figure's camera looks straight ahead."""
    return RISE if robot.skin is None else 0.0


@contextmanager
def _drawing(robot: Robot, size: tuple[int, int]) -> Iterator[Draw]:
    """Opens what draws a robot in pictures of a size [pixels], each from its own viewpoint."""
    if robot.skin is None:
        with _model_drawing(robot, size) as draw:
            yield draw
        return
    try:
        portrait = FigurePortrait(robot.skeleton, size=size)
    except DisplayError as error:
        raise FilmError(str(error)) from None
    with portrait:

        def draw_figure(angles: Floats, units: Units, view: Viewpoint) -> Picture:
            x, y, z = map(float, view.middle)
            camera = Camera(view.yaw_deg, view.distance, view.field_deg, pivot=(x, y, z))
            return portrait.draw(angles, units, camera)

        yield draw_figure


@contextmanager
def _model_drawing(robot: Robot, size: tuple[int, int]) -> Iterator[Draw]:
    """Opens MuJoCo for it, once a process of its own has shown that it draws here."""
    if why := opengl_fault():
        raise FilmError(why)
    model = styled_model(robot, width=size[0], height=size[1])
    model.vis.quality.offsamples = SAMPLES
    data, order = mujoco.MjData(model), turn_order(robot, model)
    camera = mujoco.MjvCamera()
    places, ways = model.light_pos.copy(), model.light_dir.copy()
    with mujoco.Renderer(model, size[1], size[0]) as renderer:

        def draw_model(angles: Floats, _: Units, view: Viewpoint) -> Picture:
            data.qpos[order] = robot.skeleton.turns(angles)
            turn = about(np.array([0.0, 0.0, 1.0]), radians(view.yaw_deg))
            model.light_pos[:] = view.middle + (places - view.middle) @ turn.T  # the lamps stand with the camera
            model.light_dir[:] = ways @ turn.T
            mujoco.mj_forward(model, data)
            model.vis.global_.fovy = view.field_deg
            camera.lookat[:], camera.distance = view.middle, view.distance
            camera.azimuth, camera.elevation = view.yaw_deg + 180.0, -view.rise_deg
            renderer.update_scene(data, camera=camera)
            picture: Picture = renderer.render().copy()
            return picture

        yield draw_model
