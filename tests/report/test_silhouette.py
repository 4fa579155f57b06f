"""Hands in line drawings, of robots with and without fingers."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.body.skeleton import Capsule
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.report.silhouette import hand_outline, project, silhouette
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import key_postures, plan_gesture


@pytest.mark.parametrize("side", SIDES)
def test_fingers_of_a_robot_hand_are_drawn_at_their_positions(side):
    robot = Robot.load("upper36")
    lines = [line for line in silhouette(robot, robot.skeleton.rest, {side: "index"}) if line.owner == side]
    arm = (*robot.arm(side).segments, *robot.fingers(side))
    assert len(lines) == sum(len(robot.skeleton.segments[robot.skeleton.segment(name)].capsules) for name in arm)
    frames, tip = robot.skeleton.rest_frames, robot.finger_tips(side)["index"]
    end = project(frames.origins[tip.segment] + frames.rotations[tip.segment] @ tip.place)
    assert min(np.linalg.norm(line.points - end, axis=1).min() for line in lines) < 1e-9


def test_robot_without_fingers_is_drawn_with_an_outline_of_the_hand_shape():
    robot = Robot.load("upper22")
    lines = [line for line in silhouette(robot, robot.skeleton.rest, {"l": "index"}) if line.owner == "l"]
    arm = robot.arm("l").segments[:-1]
    bones = sum(len(robot.skeleton.segments[robot.skeleton.segment(name)].capsules) for name in arm)
    assert len(lines) == bones + len(hand_outline(robot, "l", hand_shapes()["index"]))


def test_key_postures_of_a_gesture_exclude_keys_that_move_only_fingers():
    known = set_up("upper36")
    form = known.lexicon.forms_by_id["air_quotes"]  # fingers move during the stroke
    show = key_postures(form, plan_gesture(form, known), 6)
    arms = [joint for side in SIDES for joint in known.robot.arm(side).joints]
    rest = known.robot.skeleton.rest[arms]
    assert all(np.abs(angles[arms] - rest).max() > 0.3 for angles in show.postures)


def test_sphere_and_fixed_base_of_a_robot_are_visible_in_a_line_drawing():
    robot = Robot.load("upper22")
    skeleton = robot.skeleton
    sphere = Capsule(np.zeros(3), np.zeros(3), 0.1)
    segments = [
        replace(segment, capsules=(sphere,)) if segment.name == skeleton.segments[0].name else segment
        for segment in skeleton.segments
    ]
    changed = replace(robot, skeleton=replace(skeleton, segments=tuple(segments)))
    without, drawn = (silhouette(changed, skeleton.rest, {}, with_base=with_base) for with_base in (False, True))
    assert len(drawn) == len(without) + 1
    added = next(line for line in drawn if line.width == 0.2)
    assert 0.0 < np.linalg.norm(added.points[1] - added.points[0]) < 0.01
