import numpy as np
import pytest

from kinesic.bench.naturalness.likeness import DEPTH_WEIGHT, measure_appearance, nearest_pairs
from kinesic.body.robot import Robot

ROBOT = Robot.load()


def visible_points(**hinges):
    """Return visible points of a posture given as joint offsets from rest."""
    angles = np.repeat(ROBOT.skeleton.rest[None], 4, axis=0)
    for name, angle in hinges.items():
        angles[:, ROBOT.skeleton.names.index(name)] += angle
    return measure_appearance(ROBOT, angles)


def distance_of(a, b):
    return nearest_pairs({"a": a, "b": b}, 9.0)[0].distance


@pytest.mark.parametrize("hinge", ["skullbase_tilt", "vl5_roll", "l_elbow_twisting", "r_wrist_flexion"])
def test_rotation_of_a_head_trunk_or_arm_joint_changes_the_gesture_distance(hinge):
    assert distance_of(visible_points(), visible_points(**{hinge: 0.3})) > 0.005


def test_gesture_distance_is_the_largest_rms_distance_of_corresponding_body_points():
    a, b = np.zeros((4, 3, 3)), np.zeros((4, 3, 3))
    b[:, 0, 1] = 0.02
    b[:2, 2, 2] = 0.06
    assert distance_of(a, b) == pytest.approx(0.06 / np.sqrt(2))
    assert distance_of(a, b) == distance_of(b, a)


def test_depth_counts_less_in_visual_gesture_distance():
    forward, sideways = visible_points(r_shoulder_flexion=0.4), visible_points(r_shoulder_abduct=0.4)
    assert distance_of(visible_points(), forward) < distance_of(visible_points(), sideways)
    assert 0.0 < DEPTH_WEIGHT < 1.0


def test_similar_gestures_are_listed_by_distance_up_to_a_limit():
    rows = {name: np.full((2, 1, 3), [0.0, place, 0.0]) for name, place in (("a", 0.0), ("b", 0.1), ("c", 0.13))}
    assert [(pair.a, pair.b) for pair in nearest_pairs(rows, 0.11)] == [("b", "c"), ("a", "b")]
    assert nearest_pairs({}, 1.0) == []
