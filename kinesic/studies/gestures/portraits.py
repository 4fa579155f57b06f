"""Shaded pictures of a robot in given postures."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from math import radians
from types import MappingProxyType

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, Picture
from kinesic.body.robot import Robot
from kinesic.body.rotation import rotation_about
from kinesic.face.display import DisplayError
from kinesic.face.render.camera import Camera
from kinesic.face.render.figure import FigurePortrait
from kinesic.sim.film import FilmError, opengl_fault
from kinesic.sim.filming.drawn_face import SCREEN_SIZE, paint_face
from kinesic.sim.filming.offscreen import OffscreenError
from kinesic.sim.filming.scene_renderer import SceneRenderer
from kinesic.sim.model import find_turn_indices
from kinesic.sim.scene_style import styled_model
from kinesic.studies.gestures.framing import CAMERA_ELEVATION, Balls, Viewpoint

Units = Mapping[str, float]
Draw = Callable[[Floats, Units, Viewpoint], Picture]
NEUTRAL_FACE: Units = MappingProxyType({})  # face without active action units
TURNTABLE_FRAMES = 96  # number of pictures of a turntable film
TURNTABLE_RATE = 24.0  # [Hz] pictures per second of a turntable film
TURNTABLE_SIZE = 480  # [pixels] side of a turntable picture
PIXEL_SAMPLES = 4  # multisampling: samples per pixel


def draw_stills(
    robot: Robot, postures: Sequence[Floats], faces: Sequence[Units], size: tuple[int, int]
) -> tuple[Viewpoint, list[Picture]]:
    """Draw robot postures from one frontal viewpoint, and return this viewpoint.

    Args:
        robot: robot to draw.
        postures: joint angles (n,) [rad].
        faces: action units -> 0..1 per posture, on the skin or on the robot's face screen.
        size: width and height of a picture [pixels].

    Raises:
        FilmError: OpenGL is not available.
    """
    (view,) = Balls.of(robot, postures).viewpoints([0.0], size[0] / size[1], rise=_choose_elevation(robot))
    with _open_renderer(robot, size) as draw:
        return view, [draw(angles, units, view) for angles, units in zip(postures, faces, strict=True)]


def draw_turntable(
    robot: Robot, angles: Floats, units: Units = NEUTRAL_FACE, progress: Callable[[float], None] = lambda share: None
) -> list[Picture]:
    """Draw a robot's posture from all around, starting from the front.

    Args:
        robot: robot to draw.
        angles: joint angles (n,) [rad].
        units: action units -> 0..1, on the skin or on the robot's face screen.
        progress: callback with the fraction of drawn pictures.

    Raises:
        FilmError: OpenGL is not available.
    """
    yaws = [360.0 * k / TURNTABLE_FRAMES for k in range(TURNTABLE_FRAMES)]
    pictures = []
    with _open_renderer(robot, (TURNTABLE_SIZE, TURNTABLE_SIZE)) as draw:
        for view in Balls.of(robot, [angles]).viewpoints(yaws, 1.0, rise=_choose_elevation(robot)):
            pictures.append(draw(angles, units, view))
            progress(len(pictures) / TURNTABLE_FRAMES)
    return pictures


def _choose_elevation(robot: Robot) -> float:
    """Return the camera's elevation [deg].

    The result is zero for a robot with skin.
    """
    return CAMERA_ELEVATION if robot.skin is None else 0.0


@contextmanager
def _open_renderer(robot: Robot, size: tuple[int, int]) -> Iterator[Draw]:
    """Open a renderer that draws a robot in a picture size [pixels]."""
    if robot.skin is None:
        with _open_mujoco(robot, size) as draw:
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
def _open_mujoco(robot: Robot, size: tuple[int, int]) -> Iterator[Draw]:
    """Open a MuJoCo renderer, after a separate process has tested OpenGL."""
    if why := opengl_fault():
        raise FilmError(why)
    model = styled_model(robot, width=size[0], height=size[1])
    model.vis.quality.offsamples = PIXEL_SAMPLES
    data, order = mujoco.MjData(model), find_turn_indices(robot, model)
    camera = mujoco.MjvCamera()
    lamp_positions, lamp_directions = model.light_pos.copy(), model.light_dir.copy()
    with ExitStack() as closing:
        try:
            renderer = closing.enter_context(SceneRenderer(model, size))
        except OffscreenError as error:
            raise FilmError(str(error)) from None

        def draw_model(angles: Floats, units: Units, view: Viewpoint) -> Picture:
            data.qpos[order] = robot.skeleton.with_couplings(angles)
            turn = rotation_about(np.array([0.0, 0.0, 1.0]), radians(view.yaw_deg))
            model.light_pos[:] = (
                view.middle + (lamp_positions - view.middle) @ turn.T
            )  # the lamps rotate with the camera
            model.light_dir[:] = lamp_directions @ turn.T
            mujoco.mj_forward(model, data)
            model.vis.global_.fovy = view.field_deg
            camera.lookat[:], camera.distance = view.middle, view.distance
            camera.azimuth, camera.elevation = view.yaw_deg + 180.0, -view.rise_deg
            renderer.show(paint_face(units, size=SCREEN_SIZE))
            return renderer.draw(data, camera)

        yield draw_model
