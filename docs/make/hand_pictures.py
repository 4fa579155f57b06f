"""Draw docs/pictures/hands.png: every hand shape on upper36 and on the human, from the front and from the side."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Floats, Picture
from kinesic.body.robot import Robot
from kinesic.expressivity.hands.fingers import finger_joints, shape_angles
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.face.render.camera import Camera
from kinesic.face.render.figure import FigurePortrait
from kinesic.sim.filming.scene_renderer import SceneRenderer
from kinesic.sim.model import find_turn_indices
from kinesic.sim.scene_style import styled_model

SIDE, LABEL, COLUMNS = 128, 14, 3  # [pixels] of a picture and of its label; shapes per row
VIEW_YAWS = (0.0, 90.0)  # [deg] camera yaw around the hand: from the front, from the thumb's side
CAMERA_DISTANCE = 1.6  # [m] from the camera to the hand
VIEW_HEIGHTS = {"upper36": 0.155, "human": 0.205}  # [m] height of the visible area, by robot
RAISED_ANGLES = {  # [deg] angles of the left arm's hinges that show the palm
    "shoulder_abduct": 45,
    "shoulder_flexion": 20,
    "elbow_flexion": 110,
    "elbow_twisting": -85,
}
Draw = Callable[[Floats, Floats, float, float], Picture]  # angles, centre, visible height, camera yaw [deg]


def raised(robot: Robot) -> Floats:
    """Return the rest posture (n,) [rad] with the left hand raised to show its palm."""
    angles = robot.skeleton.rest.copy()
    for name, degrees in RAISED_ANGLES.items():
        angles[robot.skeleton.joint(f"l_{name}")] = np.radians(degrees)
    for name in ("wrist_flexion", "wrist_pivot"):
        angles[robot.skeleton.joint(f"l_{name}")] = 0.0
    return robot.skeleton.clamp(angles)


def of_capsules(robot: Robot) -> Draw:
    """Return a function that draws a robot's capsules in MuJoCo."""
    import mujoco  # noqa: PLC0415 - MuJoCo chooses its renderer at import, after kinesic.sim

    model = styled_model(robot, width=SIDE, height=SIDE)
    data, order, renderer = mujoco.MjData(model), find_turn_indices(robot, model), SceneRenderer(model, (SIDE, SIDE))

    def draw(angles: Floats, middle: Floats, seen: float, yaw: float) -> Picture:
        data.qpos[order] = robot.skeleton.with_couplings(angles)
        mujoco.mj_forward(model, data)
        camera = mujoco.MjvCamera()
        camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = middle, CAMERA_DISTANCE, 180 + yaw, 0
        model.vis.global_.fovy = 2 * np.degrees(np.arctan(seen / 2 / CAMERA_DISTANCE))
        return renderer.draw(data, camera)

    return draw


def of_skin(portrait: FigurePortrait) -> Draw:
    """Return a function that draws the human model's skin."""

    def draw(angles: Floats, middle: Floats, seen: float, yaw: float) -> Picture:
        field = 2 * np.degrees(np.arctan(seen / 2 / CAMERA_DISTANCE))
        x, y, z = (float(value) for value in middle)
        return portrait.draw(angles, {}, Camera(yaw, CAMERA_DISTANCE, field, pivot=(x, y, z)))

    return draw


def row(robot: Robot, name: str, draw: Draw) -> list[Picture]:
    """Draw one hand shape from each camera yaw."""
    angles = raised(robot)
    angles[list(finger_joints(robot, "l"))] = shape_angles(hand_shapes()[name], robot, "l")
    frames, hand = robot.skeleton.frames(angles), robot.arm("l").wrist
    middle = frames.origins[hand] - 0.42 * VIEW_HEIGHTS[robot.name] * frames.rotations[hand][:, 2]
    return [draw(angles, middle, VIEW_HEIGHTS[robot.name], yaw) for yaw in VIEW_YAWS]


robots = {name: Robot.load(name) for name in VIEW_HEIGHTS}
names = list(hand_shapes())
with FigurePortrait(robots["human"].skeleton, size=(SIDE, SIDE)) as portrait:
    bodies = {"upper36": of_capsules(robots["upper36"]), "human": of_skin(portrait)}
    rows = {name: [p for body, draw in bodies.items() for p in row(robots[body], name, draw)] for name in names}
wide, tall = len(VIEW_YAWS) * len(VIEW_HEIGHTS) * SIDE, SIDE + LABEL
sheet = Image.new("RGB", (COLUMNS * wide, -(-len(names) // COLUMNS) * tall), "white")
for k, name in enumerate(names):
    x, y = k % COLUMNS * wide, k // COLUMNS * tall
    for place, pixels in enumerate(rows[name]):
        sheet.paste(Image.fromarray(pixels), (x + place * SIDE, y + LABEL))
    ImageDraw.Draw(sheet).text((x + 3, y + 1), name, fill="black")
sheet.quantize(160).save(Path(__file__).parents[1] / "pictures" / "hands.png", optimize=True)
