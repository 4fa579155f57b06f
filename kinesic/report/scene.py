"""Robot geometry and camera for page scripts."""

from base64 import b64encode
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule, Coupling, Hinge
from kinesic.face.display import explain_missing_packages
from kinesic.report.figure.skin_data import skin_data
from kinesic.report.report import Json
from kinesic.sim.filming.face_screen import Sheet, build_face_screen
from kinesic.sim.part_colours import parts, shell_parts
from kinesic.sim.scene_layout import CAMERA_DIRECTION, Rod, find_scene_view
from kinesic.sim.scene_style import SERVO_DRAWN_SCALE, eyeballs, list_drawn_rods
from kinesic.sim.shells.shell import Shell
from kinesic.sim.shells.variant import find_shell

LENGTH_DIGITS = 4  # decimal places of lengths [m] in page data
TEMPLATES_FOLDER = Path(__file__).parent / "templates"
# Page scripts in loading order; they define `sceneOf`, which draws a posture, and `rowAt`, which samples a motion.
SCENE_SCRIPTS = ("shapes.js", "motion.js", "skin.js", "screen.js", "scene.js")


def scene_data(robot: Robot) -> dict[str, Json]:
    """Return a robot's geometry and camera for page scripts."""
    robot = drawable(robot)
    shell = find_shell(robot)
    return {
        "segments": _segments(robot),
        "servos": _servos(robot),
        "details": [*_eyes(robot), *_rods(robot, list_drawn_rods(robot, shell))],
        "screen": _screen(robot),
        "view": _view(robot),
        "shells": [] if shell is None else _shells(robot, shell),
        "shell_step": _shell_step(shell),
        **({} if robot.skin is None else {"skin": skin_data(robot)}),
    }


def drawable(robot: Robot) -> Robot:
    """Return a robot without its skin if SciPy or Pillow is missing.

    The skin's mesh needs SciPy, its painting Pillow. Capsules and a screen with the face take its place.
    """
    return robot if robot.skin is None or explain_missing_packages() is None else replace(robot, skin=None)


def read_scripts(names: tuple[str, ...]) -> str:
    """Join page scripts from the templates folder."""
    return "\n".join((TEMPLATES_FOLDER / name).read_text(encoding="utf-8") for name in names)


def pack_rows(values: Floats, kind: str) -> str:
    """Encode integer rows in base64, clipped to the integer type's range.

    Args:
        values: (m, n).
        kind: NumPy type, such as `<i2`.
    """
    limits = np.iinfo(kind)
    return b64encode(np.clip(np.rint(values), limits.min, limits.max).astype(kind).tobytes()).decode()


def _rounded(values: Floats) -> list[Json]:
    return [round(float(value), LENGTH_DIGITS) + 0.0 for value in values]


def _segments(robot: Robot) -> list[Json]:
    skeleton = robot.skeleton
    painted = parts(robot)
    return [
        {
            "parent": -1 if segment.parent is None else skeleton.segment(segment.parent),
            "origin": _rounded(segment.origin_in_parent),
            "hinges": [
                *(_coupling(coupling) for coupling in skeleton.couplings if coupling.segment == segment.name),
                *(_hinge(joint, skeleton.hinges[joint]) for joint in skeleton.joints_of((segment.name,))),
            ],
            "capsules": [_capsule(capsule) for capsule in segment.capsules],
            "colour": painted[segment.name],
        }
        for segment in skeleton.segments
    ]


def _hinge(joint: int, hinge: Hinge) -> dict[str, Json]:
    return {"hinge": joint, "axis": [float(value) for value in hinge.axis], "at": _rounded(hinge.at)}


def _coupling(coupling: Coupling) -> dict[str, Json]:
    axis: list[Json] = [float(value) for value in coupling.axis]
    return {"hinge": coupling.driver, "axis": axis, "at": [0, 0, 0], "ratio": coupling.ratio, "offset": coupling.offset}


def _capsule(capsule: Capsule) -> list[Json]:
    return [*_rounded(capsule.start), *_rounded(capsule.end), round(capsule.radius, LENGTH_DIGITS)]


def _servos(robot: Robot) -> list[Json]:
    """Return each servo's box at its mounting position."""
    boxes: list[Json] = []
    for joint, mount in enumerate(robot.mounts):
        width, length, height = mount.drive.servo.size
        half = np.array([mount.drive.count * width, length, height]) / 2
        segment = robot.skeleton.segment(mount.segment)
        boxes.append(
            {
                "hinge": joint,
                "segment": segment,
                "at": _rounded(mount.position),
                "half": _rounded(SERVO_DRAWN_SCALE * half),
            }
        )
    return boxes


def _screen(robot: Robot) -> Json:
    """Return segment and meshes of the head's screen, or None without one."""
    screen = build_face_screen(robot)
    if screen is None:
        return None
    segment = robot.skeleton.segment(screen.segment)
    return {"segment": segment, "picture": _sheet(screen.picture), "frame": _sheet(screen.frame)}


def _sheet(sheet: Sheet) -> dict[str, Json]:
    return {
        "places": _rounded(sheet.places.ravel()),
        "normals": _rounded(sheet.normals.ravel()),
        "shares": _rounded(sheet.texture_coordinates.ravel()),
        "triangles": [int(corner) for corner in sheet.triangles.ravel()],
    }


def _eyes(robot: Robot) -> list[Json]:
    """Return the eyeballs as coloured spheres, unless a screen shows them."""
    if build_face_screen(robot) is not None:
        return []
    return [
        {
            "segment": robot.skeleton.segment(robot.sites["eyes"].segment),
            "capsule": [*_rounded(ball.centre), *_rounded(ball.centre), ball.radius],
            "colour": "pupil" if ball.dark else "white",
        }
        for ball in eyeballs(robot)
    ]


def _rods(robot: Robot, seen: Iterable[Rod]) -> list[Json]:
    """Return the bars drawn on segments as coloured capsules."""
    painted = parts(robot)
    return [
        {"segment": robot.skeleton.segment(rod.segment), "capsule": _capsule(rod.shape), "colour": painted[rod.segment]}
        for rod in seen
    ]


def _shell_step(shell: Shell | None) -> float:
    """Return the length [m] of one integer unit in `_shells`."""
    surfaces = () if shell is None else shell.segments.values()
    return max((float(np.abs(surface.vertices).max()) for surface in surfaces), default=1.0) / np.iinfo(np.int16).max


def _shells(robot: Robot, shell: Shell) -> list[Json]:
    """Pack light and dark parts of each housing mesh in base64."""
    step, painted = _shell_step(shell), shell_parts(robot)
    return [
        {
            "segment": robot.skeleton.segment(name),
            "colour": painted[name],
            "vertices": pack_rows(surface.vertices / step, "<i2"),
            "normals": pack_rows(127 * surface.normals, "<i1"),
            "shell": pack_rows(surface.shell.astype(float), "<u2"),
            "joint": pack_rows(surface.joint.astype(float), "<u2"),
        }
        for name, surface in shell.segments.items()
    ]


def _view(robot: Robot) -> dict[str, Json]:
    """Return the film camera's target, direction and view height."""
    view = find_scene_view(robot)
    return {
        "middle": _rounded(view.middle),
        "from": list(CAMERA_DIRECTION),
        "height": round(view.height, LENGTH_DIGITS),
        "floor": round(view.floor, LENGTH_DIGITS),
    }
