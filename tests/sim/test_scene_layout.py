"""Floor, view and rods of robots of different sizes."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from PIL import Image

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule, Segment
from kinesic.sim.film import write_still
from kinesic.sim.gl import opengl_fault
from kinesic.sim.model import find_joint_indices
from kinesic.sim.scene_layout import PICTURE_ASPECT, VIEW_ANGLE, find_scene_view, rods
from kinesic.sim.scene_style import CAMERA_NAME, styled_model

UPPER22 = Robot.load()
PLANE_GEOM, BALL_GEOM, CAPSULE_GEOM = (
    int(getattr(mujoco.mjtGeom, f"mjGEOM_{kind}")) for kind in ("PLANE", "SPHERE", "CAPSULE")
)


def resized(scale: float, lift: float = 0.0) -> Robot:
    """Return the robot scaled by `scale` and lifted by `lift` [m]."""

    def segment(old: Segment) -> Segment:
        shapes = tuple(Capsule(scale * c.start, scale * c.end, scale * c.radius) for c in old.capsules)
        up = np.array([0.0, 0.0, lift if old.parent is None else 0.0])
        return replace(old, origin_in_parent=sealed(scale * old.origin_in_parent + up), capsules=shapes)

    skeleton = replace(UPPER22.skeleton, segments=tuple(map(segment, UPPER22.skeleton.segments)))
    sites = {name: replace(site, position=sealed(scale * site.position)) for name, site in UPPER22.sites.items()}
    return replace(UPPER22, skeleton=skeleton, sites=sites)


def without_column(robot: Robot) -> Robot:
    """Return the robot without the column below its trunk."""
    root, *others = robot.skeleton.segments
    return replace(
        robot, skeleton=replace(robot.skeleton, segments=(replace(root, capsules=root.capsules[-1:]), *others))
    )


ROBOTS = {
    "as it is": UPPER22,
    "sunk": resized(1.0, -1.0),
    "small": resized(0.4, -0.3),
    "tall": resized(1.6, 0.5),
    "bust": without_column(resized(0.56)),
}
every_robot = pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)


def geoms(robot: Robot, posture: Floats) -> tuple[mujoco.MjModel, mujoco.MjData, list[int]]:
    """Return the picture model in a posture, with its balls and capsules."""
    model = styled_model(robot, width=320, height=240)
    data = mujoco.MjData(model)
    data.qpos[find_joint_indices(robot, model)] = posture
    mujoco.mj_forward(model, data)
    return model, data, [k for k in range(model.ngeom) if model.geom_type[k] in (CAPSULE_GEOM, BALL_GEOM)]


def ends(model: mujoco.MjModel, data: mujoco.MjData, k: int) -> Floats:
    half = data.geom_xmat[k].reshape(3, 3)[:, 2] * model.geom_size[k, 1]
    if model.geom_type[k] == BALL_GEOM:
        half = np.zeros(3)
    return np.stack([data.geom_xpos[k] - half, data.geom_xpos[k] + half])


@every_robot
def test_drawn_robot_touches_the_floor_and_its_hanging_hands_do_not(robot: Robot):
    model, data, round_ones = geoms(robot, robot.skeleton.rest)
    (plane,) = [k for k in range(model.ngeom) if model.geom_type[k] == PLANE_GEOM]
    floor = data.geom_xpos[plane, 2]
    assert floor == pytest.approx(find_scene_view(robot).floor)
    lowest = {k: (ends(model, data, k)[:, 2] - model.geom_size[k, 0]).min() for k in round_ones}
    arms = {model.body(segment).id for side in ("l", "r") for segment in robot.chains[f"{side}_arm"]}
    assert min(low for k, low in lowest.items() if model.geom_bodyid[k] in arms) > floor, "hands hang free"
    assert min(lowest.values()) <= floor + 1e-6, "it touches the floor"


def test_robot_with_hands_below_its_trunk_stands_on_a_drawn_column():
    robot = without_column(UPPER22)
    (column,) = [rod for rod in rods(robot) if rod.segment == robot.skeleton.segments[0].name and _down(rod.shape)]
    foot = robot.skeleton.zero_frames.origins[0] + column.shape.end
    assert foot[2] == pytest.approx(find_scene_view(robot).floor)


def _down(shape: Capsule) -> bool:
    return bool(shape.end[2] < shape.start[2] - 0.1)


@every_robot
def test_camera_view_contains_head_and_arms_at_rest_and_with_a_raised_hand(robot: Robot):
    raised = robot.skeleton.rest.copy()
    raised[robot.skeleton.joint("r_shoulder_flexion")] = 2.8
    half = np.tan(np.radians(VIEW_ANGLE) / 2)
    for posture in (robot.skeleton.rest, raised):
        model, data, round_ones = geoms(robot, posture)
        eye, frame = data.camera(CAMERA_NAME).xpos, data.camera(CAMERA_NAME).xmat.reshape(3, 3)
        arms = {model.body(segment).id for side in ("l", "r") for segment in robot.chains[f"{side}_arm"]}
        head = model.body(robot.chains["neck"][-1]).id
        seen = [k for k in round_ones if model.geom_bodyid[k] in arms | {head}]
        assert seen
        for k in seen:
            for place in ends(model, data, k):
                x, y, z = (place - eye) @ frame
                assert max(abs(x) / PICTURE_ASPECT, abs(y)) < -z * half


def test_camera_view_scales_with_the_robot_size():
    small, large = find_scene_view(resized(0.5)), find_scene_view(UPPER22)
    assert small.height == pytest.approx(large.height / 2)
    assert small.middle == pytest.approx(large.middle / 2)


def test_drawn_rods_connect_all_shapes_of_a_segment_and_its_children():
    lone = [Capsule(sealed([0.0, 0.0, z]), sealed([0.0, 0.1, z]), 0.02) for z in (0.3, 0.6)]
    root, *others = UPPER22.skeleton.segments
    apart = replace(root, capsules=tuple(lone))
    robot = replace(UPPER22, skeleton=replace(UPPER22.skeleton, segments=(apart, *others)))
    own = [rod.shape for rod in rods(robot) if rod.segment == root.name]
    joined = {(round(float(shape.start[2]), 3), round(float(shape.end[2]), 3)) for shape in own}
    assert {(0.0, 0.3), (0.3, 0.6)} <= joined, "from the origin to the first shape, and from there to the next"
    child = next(segment for segment in others if segment.parent == root.name)
    assert any(np.allclose(shape.end, child.origin_in_parent) for shape in own)


@pytest.mark.parametrize("name", ["sunk", "bust"])
def test_corner_of_the_drawn_floor_has_uniform_brightness(name: str, tmp_path: Path):
    if why := opengl_fault():
        pytest.skip(why)
    robot = ROBOTS[name]
    write_still(robot, robot.skeleton.rest, tmp_path / "still.png")
    with Image.open(tmp_path / "still.png") as still:
        corner = np.asarray(still.convert("L"), dtype=float)[240:, 360:]
    assert np.abs(corner - np.median(corner)).max() < 12.0


def test_drawn_rods_are_not_thicker_than_capsules_of_their_segment():
    robot = Robot.load("upper36")
    segments = robot.skeleton.segments
    for rod in rods(robot):
        shapes = segments[robot.skeleton.segment(rod.segment)].capsules
        assert rod.shape.radius <= min((shape.radius for shape in shapes), default=1.0)
