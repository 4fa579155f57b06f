"""Colours, eyes, ground, lights and a camera for pictures of the robot. None of it has weight."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.sim.filming.drawn_face import SCREEN, paint_face
from kinesic.sim.filming.scene_screen import add_screen, has_screen, put_face
from kinesic.sim.model import capsule_name, describe
from kinesic.sim.scene_layout import SUN, VIEW_ANGLE, VIEW_FROM, Rod, SceneView, rods, stand, view_of
from kinesic.sim.shells.geoms import add_shell
from kinesic.sim.shells.shell import Shell, shell_of

CAMERA = "audience"
FLOOR_GROUP = 5  # of shapes: the floor alone is in it
RodPart = Literal["trunk", "limb", "l_hand", "r_hand"]
COLOURS: dict[RodPart, tuple[float, ...]] = {
    "trunk": (0.34, 0.42, 0.52, 1.0),
    "limb": (0.93, 0.92, 0.89, 1.0),
    "l_hand": (0.95, 0.55, 0.22, 1.0),
    "r_hand": (0.16, 0.56, 0.66, 1.0),
}
SERVO = (0.17, 0.18, 0.21, 1.0)
SERVO_DRAWN = 0.94  # of its size: corners that just come through a limb would be dark specks
SKY = (0.62, 0.74, 0.84)
HORIZON = (0.90, 0.93, 0.95)
WHITE = (1.0, 1.0, 1.0, 1.0)
BLACK = (0.06, 0.07, 0.10, 1.0)
HAZE = 0.6  # share of the way to the horizon in which the floor fades
EYE_RADIUS = 0.043  # this and what follows in arm lengths
EYE_SPACING = 0.064  # from the face's midline
EYE_DEPTH = 0.014  # of the whites' centres behind the site
PUPIL_RADIUS = 0.025
PUPIL_AHEAD = 0.0226  # of the pupils' centres before those of the whites
FILL = (-0.6, 0.7, -0.4)  # where the cool light shines
SUN_AWAY = 2.0  # picture heights from the robot


def styled_model(robot: Robot, *, width: int, height: int, view: SceneView | None = None) -> mujoco.MjModel:
    """Adds colours and scenery to the model of a robot.

    Args:
        robot: that is painted.
        width: of the largest picture that is drawn at once [pixels].
        height: likewise.
        view: what the camera sees; None: the robot, wherever its hands reach.
    """
    spec = describe(robot)
    shell = shell_of(robot)
    if shell is None:
        _paint(spec, robot)
    else:
        colours = {name: COLOURS[part] for name, part in shell_parts(robot).items()}
        add_shell(spec, robot, shell, colours=colours, joint=SERVO)
    if not add_screen(spec, robot):
        _add_eyes(spec, robot)
    _add_rods(spec, robot, seen_rods(robot, shell))
    _add_room(spec, view_of(robot) if view is None else view)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.quality.offsamples = 0  # pictures are drawn finer instead: without a card that is cheaper
    spec.visual.map.haze = HAZE
    spec.visual.quality.numslices, spec.visual.quality.numstacks = 20, 10
    spec.visual.headlight.ambient = [0.38, 0.38, 0.40]
    spec.visual.headlight.diffuse = [0.20, 0.20, 0.20]
    spec.visual.headlight.specular = [0.05, 0.05, 0.05]
    spec.visual.rgba.haze = [*HORIZON, 1.0]
    model = spec.compile()
    if has_screen(model):
        put_face(model, paint_face({}, size=SCREEN))
    return model


@dataclass(frozen=True, eq=False)
class Eyeball:
    """A ball of an eye, fixed to the segment that bears the eyes."""

    centre: Floats  # (3,) [m] in the segment
    radius: float  # [m]
    dark: bool  # a pupil


def parts(robot: Robot) -> dict[str, RodPart]:
    """Says what each segment is painted as."""
    limbs = {segment for side in SIDES for segment in robot.arm(side).segments}
    limbs |= set(robot.chains.get("neck", ()))
    painted: dict[str, RodPart] = {s.name: "limb" if s.name in limbs else "trunk" for s in robot.skeleton.segments}
    colours: dict[Side, RodPart] = {"l": "l_hand", "r": "r_hand"}
    hands = {side: (robot.arm(side).segments[-1], *robot.fingers(side)) for side in SIDES}
    return painted | {name: colours[side] for side, names in hands.items() for name in names}


def shell_parts(robot: Robot) -> dict[str, RodPart]:
    """Says what the shell of each segment is painted as: the trunk as the limbs."""
    return {name: "limb" if part == "trunk" else part for name, part in parts(robot).items()}


def seen_rods(robot: Robot, shell: Shell | None) -> tuple[Rod, ...]:
    """Gives the rods that are drawn; in its shell a robot has none but that on which it stands."""
    return rods(robot) if shell is None else tuple(stand(robot))


def eyeballs(robot: Robot) -> tuple[Eyeball, ...]:
    """Places two white balls with pupils beside the site between the eyes; none without that site."""
    eyes = robot.sites.get("eyes")
    if eyes is None:
        return ()
    sideways = np.cross([0.0, 0.0, 1.0], eyes.facing)
    if not sideways.any():
        return ()
    sideways /= np.linalg.norm(sideways)
    found, size = [], robot.arm_length
    for side in (-1, 1):
        white = eyes.position + size * (side * EYE_SPACING * sideways - EYE_DEPTH * eyes.facing)
        found.append(Eyeball(sealed(white), size * EYE_RADIUS, dark=False))
        found.append(Eyeball(sealed(white + size * PUPIL_AHEAD * eyes.facing), size * PUPIL_RADIUS, dark=True))
    return tuple(found)


def _paint(spec: mujoco.MjSpec, robot: Robot) -> None:
    painted = parts(robot)
    for segment in robot.skeleton.segments:
        for k in range(len(segment.capsules)):
            spec.geom(capsule_name(segment.name, k)).rgba = COLOURS[painted[segment.name]]
    for name in robot.skeleton.names:
        box = spec.geom(f"{name}_servo")
        box.rgba, box.size = SERVO, SERVO_DRAWN * np.array(box.size)


def _add_eyes(spec: mujoco.MjSpec, robot: Robot) -> None:
    for ball in eyeballs(robot):
        spec.body(robot.sites["eyes"].segment).add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            pos=ball.centre,
            size=[ball.radius, 0, 0],
            rgba=BLACK if ball.dark else WHITE,
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
            rgba=COLOURS[painted[rod.segment]],
            mass=0,
            contype=0,
            conaffinity=0,
        )


def _add_room(spec: mujoco.MjSpec, view: SceneView) -> None:
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=SKY,
        rgb2=HORIZON,
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
    """A sun from the robot's left, and a cool light from its right; `soft_shadow` draws what the sun does not reach."""
    sun = {"dir": SUN, "diffuse": [0.55, 0.54, 0.52], "castshadow": False}
    fill = {"dir": FILL, "diffuse": [0.22, 0.24, 0.27], "castshadow": False}
    for light in (sun, fill):
        away = view.middle - SUN_AWAY * view.height * np.array(light["dir"])
        spec.worldbody.add_light(type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, pos=away, **light)


def _add_camera(spec: mujoco.MjSpec, view: SceneView) -> None:
    """In front of the robot, so far that the picture has its height there."""
    towards = np.array(VIEW_FROM) / np.linalg.norm(VIEW_FROM)
    distance = view.height / 2 / np.tan(np.radians(VIEW_ANGLE) / 2)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    spec.worldbody.add_camera(
        name=CAMERA,
        pos=view.middle + distance * towards,
        xyaxes=[*right, *np.cross(towards, right)],
        fovy=VIEW_ANGLE,
    )
