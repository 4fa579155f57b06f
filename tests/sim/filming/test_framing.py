"""Camera framing of a motion and the changed regions of its pictures."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from PIL import Image

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.sim.film import DRAWN_MARGIN
from kinesic.sim.filming.canvas import Canvas
from kinesic.sim.filming.framing import (
    bounding_box,
    clip_below_floor,
    find_capsule_balls,
    find_motion_view,
    find_robot_boxes,
    project_points,
)
from kinesic.sim.gl import opengl_fault
from kinesic.sim.model import find_turn_indices
from kinesic.sim.scene_layout import SceneView, find_scene_view
from kinesic.sim.scene_style import styled_model

ROBOTS = {name: Robot.load(name) for name in ("upper22", "upper36")}
PICTURE_SIZE = (1280, 720)


def make_motion(robot: Robot, *moved: tuple[str, float], count: int = 6) -> Floats:
    """Return a motion from rest to the given hinge angles [rad]."""
    end = robot.skeleton.rest.copy()
    for name, angle in moved:
        end[robot.skeleton.joint(name)] = angle
    return robot.skeleton.rest + np.linspace(0.0, 1.0, count)[:, None] * (end - robot.skeleton.rest)


HINGE_TARGETS: dict[str, tuple[tuple[str, float], ...]] = {
    "still": (),
    "one up": (("r_shoulder_flexion", 2.8),),
    "both forward": (("r_shoulder_flexion", 1.5), ("l_shoulder_flexion", 1.5)),
}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("moved", HINGE_TARGETS.values(), ids=HINGE_TARGETS)
def test_hands_and_head_fill_the_camera_view_of_a_motion_up_to_the_margin(
    name: str, moved: tuple[tuple[str, float], ...]
):
    robot = ROBOTS[name]
    postures = make_motion(robot, *moved)
    view = find_motion_view(robot, postures, aspect=16 / 9)
    ends = [segment for side in SIDES for segment in (robot.arm(side).segments[-1], *robot.fingers(side))]
    places, radii = find_capsule_balls(robot, postures, [*ends, robot.chains["neck"][-1]])
    seen = project_points(view, places, size=PICTURE_SIZE)
    reach = seen[..., 2] * radii
    free = [
        float(edge) / PICTURE_SIZE[k]
        for k in (0, 1)
        for edge in ((seen[..., k] - reach).min(), (PICTURE_SIZE[k] - seen[..., k] - reach).min())
    ]
    assert min(free) > 0.07
    assert max(free[2:]) < 0.14 or max(free[:2]) < 0.12, "no more is free than the margin, across or up"


@pytest.mark.parametrize("name", ROBOTS)
def test_camera_view_grows_only_for_motions_that_leave_the_usual_view(name: str):
    robot = ROBOTS[name]
    bent = [(f"{side}_elbow_flexion", 0.9) for side in SIDES]
    views = [find_motion_view(robot, make_motion(robot, *moved), aspect=16 / 9) for moved in ((), bent[:1], bent)]
    for view in views[1:]:
        assert view.height == views[0].height
        assert view.middle == pytest.approx(views[0].middle)
    raised = find_motion_view(robot, make_motion(robot, *HINGE_TARGETS["one up"]), aspect=16 / 9)
    assert raised.height > 1.05 * views[0].height, "a hand over the head is shown, too"
    assert raised.middle[2] > views[0].middle[2]


def test_view_of_a_robot_does_not_depend_on_its_rest_posture():
    robot = ROBOTS["upper22"]
    hinges = tuple(replace(hinge, rest=hinge.rest + 0.3) for hinge in robot.skeleton.hinges)
    other = replace(robot, skeleton=replace(robot.skeleton, hinges=hinges))
    still = robot.skeleton.rest[None]
    assert find_scene_view(other).height == find_scene_view(robot).height
    assert find_scene_view(other).floor == find_scene_view(robot).floor
    views = [find_motion_view(one, still, aspect=16 / 9) for one in (robot, other)]
    assert views[0].height == views[1].height


def test_camera_projection_enlarges_near_points_and_centres_the_middle_of_the_view():
    robot = ROBOTS["upper22"]
    view = find_motion_view(robot, make_motion(robot), aspect=16 / 9)
    x, y, scale = project_points(view, view.middle, size=PICTURE_SIZE)
    assert (x, y) == pytest.approx((640, 360))
    assert scale == pytest.approx(720 / view.height)
    assert project_points(view, view.middle + np.array([0.3, 0.1, 0.0]), size=PICTURE_SIZE)[2] > scale


def draw_scene(room: Image.Image, robot: Image.Image) -> np.ndarray:
    """Draw a robot in front of its background."""
    seen = room.copy()
    seen.paste(robot, None, robot)
    return np.asarray(seen)


def test_joined_bounding_box_is_the_smallest_box_that_contains_both_boxes():
    assert bounding_box((2, 4, 8, 9), (4, 0, 20, 6)) == (2, 0, 20, 9)


@pytest.mark.parametrize("name", ROBOTS)
def test_pixels_changed_by_the_robot_lie_within_the_reported_box(name: str):
    if why := opengl_fault():
        pytest.skip(why)
    robot, size = ROBOTS[name], (320, 180)
    postures = make_motion(robot, *HINGE_TARGETS["one up"], count=3)
    view = find_motion_view(robot, postures, aspect=16 / 9)
    places, radii = find_capsule_balls(robot, postures, [segment.name for segment in robot.skeleton.segments])
    boxes = find_robot_boxes(
        project_points(view, places, size=size), radii + DRAWN_MARGIN * robot.arm_length, size=size
    )
    model = styled_model(robot, width=640, height=360, view=view)
    data, order = mujoco.MjData(model), find_turn_indices(robot, model)
    with Canvas(model, size, supersampling=2) as canvas:
        for posture, box in zip(postures, boxes, strict=True):
            data.qpos[order] = robot.skeleton.with_couplings(posture)
            mujoco.mj_forward(model, data)
            room, drawn = canvas.draw_empty(data), canvas.draw(data)
            empty, whole = np.asarray(room), draw_scene(room, drawn)
            left, top, right, low = box
            part = draw_scene(room.crop(box), canvas.draw(data, box))
            free = 255 - np.asarray(drawn.getchannel("a"))
            assert np.abs(part.astype(int) - whole[top:low, left:right]).mean() < 0.5, "a part is as in the whole"
            differs = np.abs(whole.astype(int) - empty).max(axis=2) > 3
            assert differs.sum() > 1000
            assert (free[differs] < 255).mean() > 0.99, "the robot hides the floor where it is seen"
            assert (free == 255).mean() > 0.5
            differs[top:low, left:right] = False
            assert not differs.any()


def test_capsules_below_the_floor_are_clipped_at_the_floor():
    """Clip a sunk column, a falling bar and a raised bar."""
    column, falling, above = (
        [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]],
        [[1.0, 0.0, 0.5], [2.0, 0.0, 0.5]],
        [[0.0, 3.0, 0.9]] * 2,
    )
    sunk = [[1.0, 0.0, -0.5], [2.0, 0.0, 0.5]]
    places = np.array([[*column, *falling, *above], [*column, *sunk, *above]])
    ends, around = clip_below_floor(places, np.full(6, 0.1), 0.0)
    assert around == pytest.approx(np.full(4, 0.1))
    assert ends[:, :2] == pytest.approx(np.array([[[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]] * 2))
    assert ends[1, 2:] == pytest.approx(np.array([[1.0, 0.0, -0.5], [1.6, 0.0, 0.1]]))
    assert clip_below_floor(places[:, 4:], np.full(2, 0.1), 0.0)[0].shape == (2, 0, 3)


def test_floor_of_the_scene_hides_capsules_below_it():
    """Draw a robot whose column is cut off by a raised floor."""
    if why := opengl_fault():
        pytest.skip(why)
    robot, size = ROBOTS["upper22"], (160, 120)
    view = find_scene_view(robot)
    low = SceneView(view.floor + 0.2 * view.height, sealed(view.middle - [0.0, 0.0, 0.2 * view.height]), view.height)
    model = styled_model(robot, width=320, height=240, view=low)
    data = mujoco.MjData(model)
    data.qpos[find_turn_indices(robot, model)] = robot.skeleton.with_couplings(robot.skeleton.rest)
    mujoco.mj_forward(model, data)
    x, y, _ = project_points(low, sealed([*robot.skeleton.zero_frames.origins[0][:2], low.floor]), size=size)
    with Canvas(model, size, supersampling=2) as canvas:
        seen, all_of_it = (np.asarray(canvas.draw(data, sunk=part).getchannel("a")) for part in ((0, 0, *size), None))
        again = np.asarray(canvas.draw(data, (40, 20, 120, 120), sunk=(0, 60, *size)).getchannel("a"))
    rows = [int(np.flatnonzero(alpha[:, round(float(x))]).max()) for alpha in (seen, all_of_it)]
    assert rows[0] == pytest.approx(y, abs=3)
    assert rows[1] > rows[0] + 10
    assert (again == seen[20:120, 40:120]).mean() > 0.98
