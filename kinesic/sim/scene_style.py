"""Colours, eyes, floor, lights and camera for pictures of the robot.

All of them are massless.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.sim.filming.drawn_face import SCREEN_SIZE, paint_face
from kinesic.sim.filming.scene_screen import add_screen, has_screen, put_face
from kinesic.sim.model import capsule_name, describe
from kinesic.sim.part_colours import PART_COLOURS, parts, shell_parts
from kinesic.sim.scene_layout import (
    CAMERA_DIRECTION,
    SUN_DIRECTION,
    VIEW_ANGLE,
    Rod,
    SceneView,
    find_scene_view,
    rods,
    stand,
)
from kinesic.sim.shells.geoms import add_shell
from kinesic.sim.shells.shell import Shell
from kinesic.sim.shells.variant import find_shell

CAMERA_NAME = "audience"  # name of the MuJoCo model's camera
FLOOR_GROUP = 5  # MuJoCo geom group of the floor
SERVO_COLOUR = (0.17, 0.18, 0.21, 1.0)  # RGBA colour of servo boxes
SERVO_DRAWN_SCALE = 0.94  # drawn size / real size: protruding corners would look like dark specks on a limb
SKY_COLOUR = (0.62, 0.74, 0.84)  # RGB colour of the sky
HORIZON_COLOUR = (0.90, 0.93, 0.95)  # RGB colour of the horizon
EYE_COLOUR = (1.0, 1.0, 1.0, 1.0)  # RGBA colour of the white of the eye
PUPIL_COLOUR = (0.06, 0.07, 0.10, 1.0)  # RGBA colour of the pupils
FLOOR_HAZE = 0.6  # fraction of the distance to the horizon over which the floor fades
EYE_RADIUS = 0.043  # [arm lengths] radius of an eyeball
EYE_SPACING = 0.064  # [arm lengths] distance of an eyeball's centre from the face's midline
EYE_DEPTH = 0.014  # [arm lengths] distance of the eyeballs' centres behind the site `eyes`
PUPIL_RADIUS = 0.025  # [arm lengths] radius of a pupil
PUPIL_OFFSET = 0.0226  # [arm lengths] distance of a pupil's centre in front of its eyeball's centre
FILL_DIRECTION = (-0.6, 0.7, -0.4)  # propagation direction of the cool fill light
LIGHT_DISTANCE = 2.0  # [picture heights] distance from the robot to the lights


def styled_model(robot: Robot, *, width: int, height: int, view: SceneView | None = None) -> mujoco.MjModel:
    """Build the model of a robot with colours and scenery.

    Args:
        robot: Description.
        width: [pixels] of the largest picture that is drawn at once.
        height: [pixels] of the largest picture that is drawn at once.
        view: View of the camera; None: a view that contains the hands in all postures.
    """
    spec = describe(robot)
    shell = find_shell(robot)
    if shell is None:
        _paint(spec, robot)
    else:
        colours = {name: PART_COLOURS[part] for name, part in shell_parts(robot).items()}
        add_shell(spec, robot, shell, colours=colours, joint=SERVO_COLOUR)
    if not add_screen(spec, robot):
        _add_eyes(spec, robot)
    _add_rods(spec, robot, list_drawn_rods(robot, shell))
    _add_room(spec, find_scene_view(robot) if view is None else view)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.quality.offsamples = 0  # supersampling is used instead, which is cheaper without a graphics card
    spec.visual.map.haze = FLOOR_HAZE
    spec.visual.quality.numslices, spec.visual.quality.numstacks = 20, 10
    spec.visual.headlight.ambient = [0.38, 0.38, 0.40]
    spec.visual.headlight.diffuse = [0.20, 0.20, 0.20]
    spec.visual.headlight.specular = [0.05, 0.05, 0.05]
    spec.visual.rgba.haze = [*HORIZON_COLOUR, 1.0]
    model = spec.compile()
    if has_screen(model):
        put_face(model, paint_face({}, size=SCREEN_SIZE))
    return model


@dataclass(frozen=True, eq=False)
class Eyeball:
    """White or pupil of an eye, a ball on a segment."""

    centre: Floats  # (3,) [m] in the segment's frame
    radius: float  # [m]
    dark: bool  # whether this is a pupil


def list_drawn_rods(robot: Robot, shell: Shell | None) -> tuple[Rod, ...]:
    """Return the connecting rods to draw for a robot.

    A robot with a shell needs only the column on which it stands.
    """
    return rods(robot) if shell is None else tuple(stand(robot))


def eyeballs(robot: Robot) -> tuple[Eyeball, ...]:
    """Return two white balls with pupils around the site `eyes`.

    Empty if the robot has no site `eyes`, or one that faces vertically.
    """
    eyes = robot.sites.get("eyes")
    if eyes is None:
        return ()
    sideways = np.cross([0.0, 0.0, 1.0], eyes.facing)
    if not sideways.any():
        return ()
    sideways /= np.linalg.norm(sideways)
    balls, size = [], robot.arm_length
    for side in (-1, 1):
        white = eyes.position + size * (side * EYE_SPACING * sideways - EYE_DEPTH * eyes.facing)
        balls.append(Eyeball(sealed(white), size * EYE_RADIUS, dark=False))
        balls.append(Eyeball(sealed(white + size * PUPIL_OFFSET * eyes.facing), size * PUPIL_RADIUS, dark=True))
    return tuple(balls)


def _paint(spec: mujoco.MjSpec, robot: Robot) -> None:
    painted = parts(robot)
    for segment in robot.skeleton.segments:
        for k in range(len(segment.capsules)):
            spec.geom(capsule_name(segment.name, k)).rgba = PART_COLOURS[painted[segment.name]]
    for name in robot.skeleton.names:
        box = spec.geom(f"{name}_servo")
        box.rgba, box.size = SERVO_COLOUR, SERVO_DRAWN_SCALE * np.array(box.size)


def _add_eyes(spec: mujoco.MjSpec, robot: Robot) -> None:
    for ball in eyeballs(robot):
        spec.body(robot.sites["eyes"].segment).add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            pos=ball.centre,
            size=[ball.radius, 0, 0],
            rgba=PUPIL_COLOUR if ball.dark else EYE_COLOUR,
            mass=0,
            contype=0,
            conaffinity=0,
        )


def _add_rods(spec: mujoco.MjSpec, robot: Robot, seen: Iterable[Rod]) -> None:
    painted = parts(robot)
    for rod in seen:
        spec.body(rod.segment).add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=np.concatenate([rod.shape.start, rod.shape.end]),
            size=[rod.shape.radius, 0, 0],
            rgba=PART_COLOURS[painted[rod.segment]],
            mass=0,
            contype=0,
            conaffinity=0,
        )


def _add_room(spec: mujoco.MjSpec, view: SceneView) -> None:
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=SKY_COLOUR,
        rgb2=HORIZON_COLOUR,
        width=256,
        height=256,
    )
    spec.add_material(name="floor", rgba=[0.70, 0.73, 0.74, 1], specular=0.1, shininess=0.1)
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        pos=[0, 0, view.floor],
        size=[0, 0, 0.05],
        material="floor",
        group=FLOOR_GROUP,
        contype=0,
        conaffinity=0,
    )
    _add_lights(spec, view)
    _add_camera(spec, view)


def _add_lights(spec: mujoco.MjSpec, view: SceneView) -> None:
    """Add a sun at the robot's left and a cool fill light.

    `soft_shadow` draws the shadow of the sun.
    """
    sun = {"dir": SUN_DIRECTION, "diffuse": [0.55, 0.54, 0.52], "castshadow": False}
    fill = {"dir": FILL_DIRECTION, "diffuse": [0.22, 0.24, 0.27], "castshadow": False}
    for light in (sun, fill):
        position = view.middle - LIGHT_DISTANCE * view.height * np.array(light["dir"])
        spec.worldbody.add_light(type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, pos=position, **light)


def _add_camera(spec: mujoco.MjSpec, view: SceneView) -> None:
    """Place a camera in front of the robot.

    Its distance gives the view its height.
    """
    backward = np.array(CAMERA_DIRECTION) / np.linalg.norm(CAMERA_DIRECTION)
    distance = view.height / 2 / np.tan(np.radians(VIEW_ANGLE) / 2)
    right = np.cross([0.0, 0.0, 1.0], backward)
    right /= np.linalg.norm(right)
    spec.worldbody.add_camera(
        name=CAMERA_NAME,
        pos=view.middle + distance * backward,
        xyaxes=[*right, *np.cross(backward, right)],
        fovy=VIEW_ANGLE,
    )
