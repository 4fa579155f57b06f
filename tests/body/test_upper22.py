"""Tests of the default robot's design: hinges, servos, masses and symmetry."""

from collections import Counter

import numpy as np
import pytest

from kinesic.body.robot import Robot

SPECIFIED_RANGES_DEG = {
    "vl5_torsion": (-50, 50),
    "vl5_tilt": (-15, 35),
    "vl5_roll": (-20, 20),
    "skullbase_torsion": (-75, 75),
    "skullbase_tilt": (-35, 40),
    "skullbase_roll": (-25, 25),
    "sternoclavicular_abduct": (-10, 25),
    "shoulder_flexion": (-50, 170),
    "shoulder_abduct": (-40, 120),
    "shoulder_twisting": (-90, 90),
    "elbow_flexion": (0, 135),
    "elbow_twisting": (-85, 85),
    "wrist_flexion": (-60, 60),
    "wrist_pivot": (-30, 30),
}
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("upper22")


def test_upper22_has_22_hinges_and_23_servos(robot: Robot):
    assert len(robot.skeleton.hinges) == 22
    assert sum(drive.count for drive in robot.drives) == 23
    pieces = Counter[str]()
    for drive in robot.drives:
        pieces[drive.servo.name] += drive.count
    assert pieces == {"xm540_w270": 5, "xm540_w150": 5, "xm430_w210": 4, "xc430_w240": 5, "xc330_t288": 4}


def test_upper22_arm_is_between_42_and_55_cm_long(robot: Robot):
    assert 0.42 - 1e-12 <= robot.arm_length <= 0.55


def test_upper22_joint_ranges_include_the_specified_ranges(robot: Robot):
    for hinge in robot.skeleton.hinges:
        lower, upper = SPECIFIED_RANGES_DEG[hinge.name.removeprefix("l_").removeprefix("r_")]
        assert np.degrees(hinge.lower) <= lower + 1e-9, hinge.name
        assert np.degrees(hinge.upper) >= upper - 1e-9, hinge.name


def test_each_upper22_link_weighs_at_least_1_3_times_its_servos(robot: Robot):
    """Expect 30 % of the servo mass for frames, covers and cables."""
    for segment in robot.skeleton.segments:
        carried = [m.drive.count * m.drive.servo.mass for m in robot.mounts if m.segment == segment.name]
        assert segment.mass + sum(carried) >= 1.3 * sum(carried), segment.name


def test_upper22_has_43_collision_pairs_and_10_mm_minimum_clearance(robot: Robot):
    assert len(robot.counted_pairs) == 43
    assert robot.min_clearance == 0.010


def test_left_segments_of_upper22_exactly_mirror_right_segments(robot: Robot):
    skeleton = robot.skeleton
    for left in (segment for segment in skeleton.segments if segment.name.startswith("l_")):
        right = skeleton.segments[skeleton.segment("r_" + left.name[2:])]
        assert right.parent == left.parent.replace("l_", "r_")
        assert right.mass == left.mass
        np.testing.assert_array_equal(right.origin_in_parent, left.origin_in_parent * MIRROR_SIGNS)
        for mine, other in zip(left.capsules, right.capsules, strict=True):
            assert mine.radius == other.radius
            np.testing.assert_array_equal(mine.start * MIRROR_SIGNS, other.start)
            np.testing.assert_array_equal(mine.end * MIRROR_SIGNS, other.end)


def test_left_joints_of_upper22_exactly_mirror_right_joints(robot: Robot):
    for j, left in enumerate(robot.skeleton.hinges):
        if not left.name.startswith("l_"):
            continue
        k = robot.skeleton.joint("r_" + left.name[2:])
        right = robot.skeleton.hinges[k]
        assert (left.lower, left.upper, left.rest) == (right.lower, right.upper, right.rest)
        np.testing.assert_array_equal(right.axis, -left.axis * MIRROR_SIGNS)  # a mirrored turn goes the other way round
        assert robot.drives[j] == robot.drives[k]
        np.testing.assert_array_equal(robot.mounts[k].position, robot.mounts[j].position * MIRROR_SIGNS)


def test_midline_segments_of_upper22_have_zero_lateral_offset(robot: Robot):
    for segment in robot.skeleton.segments:
        if segment.name[:2] not in ("l_", "r_"):
            assert segment.origin_in_parent[1] == 0.0, segment.name


def test_upper22_elbows_are_bent_by_at_least_10_degrees_at_rest(robot: Robot):
    for side in ("l", "r"):
        assert np.degrees(robot.skeleton.hinges[robot.skeleton.joint(f"{side}_elbow_flexion")].rest) >= 10
