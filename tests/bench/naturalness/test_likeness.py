import numpy as np
import pytest

from kinesic.bench.naturalness.likeness import DEPTH, measure_appearance, nearest_pairs
from kinesic.body.robot import Robot

ROBOT = Robot.load()


def seen(**hinges):
    """What is seen of a posture that is held, its hinges turned from rest by so much [rad]."""
    angles = np.repeat(ROBOT.skeleton.rest[None], 4, axis=0)
    for name, angle in hinges.items():
        angles[:, ROBOT.skeleton.names.index(name)] += angle
    return measure_appearance(ROBOT, angles)


def apart(a, b):
    return nearest_pairs({"a": a, "b": b}, 9.0)[0].distance


@pytest.mark.parametrize("hinge", ["skullbase_tilt", "vl5_roll", "l_elbow_twisting", "r_wrist_flexion"])
def test_every_part_of_the_upper_body_tells_gestures_apart(hinge):
    assert apart(seen(), seen(**{hinge: 0.3})) > 0.005


def test_the_point_that_differs_most_counts_over_the_whole_stroke():
    a, b = np.zeros((4, 3, 3)), np.zeros((4, 3, 3))
    b[:, 0, 1] = 0.02
    b[:2, 2, 2] = 0.06
    assert apart(a, b) == pytest.approx(0.06 / np.sqrt(2))
    assert apart(a, b) == apart(b, a)


def test_depth_counts_less():
    forward, aside = seen(r_shoulder_flexion=0.4), seen(r_shoulder_abduct=0.4)
    assert apart(seen(), forward) < apart(seen(), aside)
    assert 0.0 < DEPTH < 1.0


def test_pairs_are_listed_nearest_first_up_to_a_distance():
    rows = {name: np.full((2, 1, 3), [0.0, place, 0.0]) for name, place in (("a", 0.0), ("b", 0.1), ("c", 0.13))}
    assert [(pair.a, pair.b) for pair in nearest_pairs(rows, 0.11)] == [("b", "c"), ("a", "b")]
    assert nearest_pairs({}, 1.0) == []
