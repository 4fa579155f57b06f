"""Framing shows all moving parts of any robot."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.report.silhouette import OutlineWindow, silhouette
from kinesic.session.setup import set_up
from kinesic.studies.gestures.framing import Balls, Viewpoint

ROBOTS = ("upper22", "upper36", "human")


@pytest.mark.parametrize("name", ROBOTS)
def test_drawing_window_contains_head_and_hands(name: str):
    robot = Robot.load(name)
    lines = silhouette(robot, robot.skeleton.rest, {})
    window = OutlineWindow.around(lines)
    for line in lines:
        assert (np.abs(line.points[:, 0]) + line.width / 2 < window.wide / 2).all()
        assert (line.points[:, 1] - line.width / 2 > window.low).all()
        assert (line.points[:, 1] + line.width / 2 < window.low + window.tall).all()
    assert window.tall < 1.25 * robot.skeleton.zero_frames.origins[robot.skeleton.segment("skullbase"), 2]


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("aspect", [0.6, 1.0, 2.0])
def test_moving_segments_are_in_the_picture_from_all_directions(name: str, aspect: float):
    robot = Robot.load(name)
    lower, upper = robot.skeleton.lower, robot.skeleton.upper
    postures = np.random.default_rng(3).uniform(lower, upper, (4, len(lower)))
    balls = Balls.of(robot, list(postures))
    fullest = 0.0
    for view in balls.viewpoints(range(0, 360, 30), aspect, rise=5.0):
        up = view.axes()[:, 1]
        right = view.axes()[:, 0]
        for way, limit, axis in ((up, 0.5, 1), (right, 0.5 * aspect, 0)):
            for sign in (-1, 1):
                edges = view.project(balls.centres + sign * balls.radii[:, None] * way)[:, axis]
                assert np.abs(edges).max() < limit
                fullest = max(fullest, float(np.abs(edges).max()) / limit)
    assert fullest > 0.85


def test_drawing_viewpoint_projects_points_like_a_camera():
    view = Viewpoint(np.array([0.0, 0.0, 1.0]), 2.0, field_deg=90.0)
    assert view.project(np.array([0.0, 0.4, 1.0])) == pytest.approx(
        [0.1, 0.0]
    )  # the robot's left is right in the picture
    assert view.project(np.array([1.0, 0.0, 1.4])) == pytest.approx([0.0, 0.2])  # nearer is larger
    side = replace(view, yaw_deg=90.0)
    assert side.project(np.array([-0.4, 0.0, 1.0])) == pytest.approx([0.1, 0.0])


def test_camera_view_of_a_gesture_excludes_motionless_legs():
    robot = Robot.load("human")
    low = Balls.of(robot, [robot.skeleton.rest]).centres[:, 2].min()
    assert low > 0.5


def test_robot_without_moving_shapes_is_framed_as_a_whole():
    robot = set_up("upper22").robot
    root = replace(robot.skeleton.segments[0], capsules=robot.skeleton.segments[-1].capsules or _any_capsules(robot))
    still = (root, *(replace(segment, capsules=()) for segment in robot.skeleton.segments[1:]))
    bare = replace(robot, skeleton=replace(robot.skeleton, segments=still))
    assert len(Balls.of(bare, [bare.skeleton.rest]).centres) == 2 * len(root.capsules) > 0


def _any_capsules(robot: Robot):
    return next(segment.capsules for segment in robot.skeleton.segments if segment.capsules)
