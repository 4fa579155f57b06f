"""The camera of a film holds the hands and the head of its motion, and what is drawn anew holds all that moves."""

import mujoco
import numpy as np
import pytest
from PIL import Image

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.sim.film import REACH
from kinesic.sim.filming.canvas import Canvas
from kinesic.sim.filming.framing import bounding_box, motion_view, moving_balls, robot_boxes, seen_at, sunk_balls
from kinesic.sim.gl import opengl_fault
from kinesic.sim.model import turn_order
from kinesic.sim.scene_layout import SceneView, view_of
from kinesic.sim.scene_style import styled_model

ROBOTS = {name: Robot.load(name) for name in ("upper22", "upper36")}
SIZE = (1280, 720)


def waving(robot: Robot, *moved: tuple[str, float], count: int = 6) -> Floats:
    """A motion in which hinges go from rest to their angles [rad]."""
    end = robot.skeleton.rest.copy()
    for name, angle in moved:
        end[robot.skeleton.joint(name)] = angle
    return robot.skeleton.rest + np.linspace(0.0, 1.0, count)[:, None] * (end - robot.skeleton.rest)


MOTIONS: dict[str, tuple[tuple[str, float], ...]] = {
    "still": (),
    "one up": (("r_shoulder_flexion", 2.8),),
    "both forward": (("r_shoulder_flexion", 1.5), ("l_shoulder_flexion", 1.5)),
}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("moved", MOTIONS.values(), ids=MOTIONS)
def test_hands_and_head_stay_in_the_picture_with_a_margin_that_is_used(name: str, moved: tuple[tuple[str, float], ...]):
    robot = ROBOTS[name]
    postures = waving(robot, *moved)
    view = motion_view(robot, postures, aspect=16 / 9)
    ends = [segment for side in SIDES for segment in (robot.arm(side).segments[-1], *robot.fingers(side))]
    places, radii = moving_balls(robot, postures, [*ends, robot.chains["neck"][-1]])
    seen = seen_at(view, places, size=SIZE)
    reach = seen[..., 2] * radii
    free = [
        float(edge) / SIZE[k]
        for k in (0, 1)
        for edge in ((seen[..., k] - reach).min(), (SIZE[k] - seen[..., k] - reach).min())
    ]
    assert min(free) > 0.07
    assert max(free[2:]) < 0.12 or max(free[:2]) < 0.12, "no more is free than the margin, across or up"


def test_what_is_nearer_is_larger_and_the_middle_is_in_the_middle():
    robot = ROBOTS["upper22"]
    view = motion_view(robot, waving(robot), aspect=16 / 9)
    x, y, scale = seen_at(view, view.middle, size=SIZE)
    assert (x, y) == pytest.approx((640, 360))
    assert scale == pytest.approx(720 / view.height)
    assert seen_at(view, view.middle + np.array([0.3, 0.1, 0.0]), size=SIZE)[2] > scale


def standing_in(room: Image.Image, robot: Image.Image) -> np.ndarray:
    """A robot before its room."""
    seen = room.copy()
    seen.paste(robot, None, robot)
    return np.asarray(seen)


def test_the_least_box_of_two():
    assert bounding_box((2, 4, 8, 9), (4, 0, 20, 6)) == (2, 0, 20, 9)


@pytest.mark.parametrize("name", ROBOTS)
def test_all_that_differs_from_the_empty_picture_is_in_the_box(name: str):
    if why := opengl_fault():
        pytest.skip(why)
    robot, size = ROBOTS[name], (320, 180)
    postures = waving(robot, *MOTIONS["one up"], count=3)
    view = motion_view(robot, postures, aspect=16 / 9)
    places, radii = moving_balls(robot, postures, [segment.name for segment in robot.skeleton.segments])
    boxes = robot_boxes(seen_at(view, places, size=size), radii + REACH * robot.arm_length, size=size)
    model = styled_model(robot, width=640, height=360, view=view)
    data, order = mujoco.MjData(model), turn_order(robot, model)
    with Canvas(model, size, finer=2) as canvas:
        for posture, box in zip(postures, boxes, strict=True):
            data.qpos[order] = robot.skeleton.turns(posture)
            mujoco.mj_forward(model, data)
            room, drawn = canvas.draw_empty(data), canvas.draw(data)
            empty, whole = np.asarray(room), standing_in(room, drawn)
            left, top, right, low = box
            part = standing_in(room.crop(box), canvas.draw(data, box))
            free = 255 - np.asarray(drawn.getchannel("a"))
            assert np.abs(part.astype(int) - whole[top:low, left:right]).mean() < 0.5, "a part is as in the whole"
            differs = np.abs(whole.astype(int) - empty).max(axis=2) > 3
            assert differs.sum() > 1000
            assert (free[differs] < 255).mean() > 0.99, "the robot hides the floor where it is seen"
            assert (free == 255).mean() > 0.5
            differs[top:low, left:right] = False
            assert not differs.any()


def test_what_is_above_the_floor_is_cut_off_from_what_sinks():
    """A column into the floor, a bar that only falls below it later, and one that stays above."""
    column, falling, above = (
        [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]],
        [[1.0, 0.0, 0.5], [2.0, 0.0, 0.5]],
        [[0.0, 3.0, 0.9]] * 2,
    )
    sunk = [[1.0, 0.0, -0.5], [2.0, 0.0, 0.5]]
    places = np.array([[*column, *falling, *above], [*column, *sunk, *above]])
    ends, around = sunk_balls(places, np.full(6, 0.1), 0.0)
    assert around == pytest.approx(np.full(4, 0.1))
    assert ends[:, :2] == pytest.approx(np.array([[[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]] * 2))
    assert ends[1, 2:] == pytest.approx(np.array([[1.0, 0.0, -0.5], [1.6, 0.0, 0.1]]))
    assert sunk_balls(places[:, 4:], np.full(2, 0.1), 0.0)[0].shape == (2, 0, 3)


def test_the_floor_hides_what_is_below_it():
    """The column ends where a floor begins that is too high for it, in a part of the picture, too."""
    if why := opengl_fault():
        pytest.skip(why)
    robot, size = ROBOTS["upper22"], (160, 120)
    view = view_of(robot)
    low = SceneView(view.floor + 0.2 * view.height, sealed(view.middle - [0.0, 0.0, 0.2 * view.height]), view.height)
    model = styled_model(robot, width=320, height=240, view=low)
    data = mujoco.MjData(model)
    data.qpos[turn_order(robot, model)] = robot.skeleton.turns(robot.skeleton.rest)
    mujoco.mj_forward(model, data)
    x, y, _ = seen_at(low, sealed([*robot.skeleton.straight.origins[0][:2], low.floor]), size=size)
    with Canvas(model, size, finer=2) as canvas:
        seen, all_of_it = (np.asarray(canvas.draw(data, sunk=part).getchannel("a")) for part in ((0, 0, *size), None))
        again = np.asarray(canvas.draw(data, (40, 20, 120, 120), sunk=(0, 60, *size)).getchannel("a"))
    rows = [int(np.flatnonzero(alpha[:, round(float(x))]).max()) for alpha in (seen, all_of_it)]
    assert rows[0] == pytest.approx(y, abs=3)
    assert rows[1] > rows[0] + 10
    assert (again == seen[20:120, 40:120]).mean() > 0.98
