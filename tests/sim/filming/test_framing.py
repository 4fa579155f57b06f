"""The camera of a film holds the hands and the head of its motion, and what is drawn anew holds all that moves."""

import mujoco
import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.sim.film import REACH
from kinesic.sim.filming.canvas import Canvas
from kinesic.sim.filming.framing import joined, motion_view, moving_balls, robot_boxes, seen_at
from kinesic.sim.filming.soft_shadow import stand_in
from kinesic.sim.gl import opengl_fault
from kinesic.sim.model import turn_order
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


def test_the_least_box_of_two():
    assert joined((2, 4, 8, 9), (4, 0, 20, 6)) == (2, 0, 20, 9)


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
            empty, (drawn, free) = canvas.draw_empty(data), canvas.draw(data)
            whole = stand_in(drawn, free, empty)
            left, top, right, low = box
            part = stand_in(*canvas.draw(data, box), empty[top:low, left:right])
            assert np.abs(part.astype(int) - whole[top:low, left:right]).mean() < 0.5, "a part is as in the whole"
            differs = np.abs(whole.astype(int) - empty).max(axis=2) > 3
            assert differs.sum() > 1000
            assert (free[differs] < 255).mean() > 0.99, "the robot hides the floor where it is seen"
            assert (free == 255).mean() > 0.5
            differs[top:low, left:right] = False
            assert not differs.any()
