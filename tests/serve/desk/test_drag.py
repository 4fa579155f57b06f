"""Postures for a dragged elbow, trunk or gaze: ranges, clearance and obstacles."""

import numpy as np
import pytest

from kinesic.serve.desk.drag import drag_part

CHAIN_OF_PART = {"elbow": "l_arm", "trunk": "torso", "gaze": "neck"}  # dragged body part -> kinematic chain that moves


def raised(robot):
    """Return a posture with both forearms in front, so that elbows can swing."""
    posture = np.array(robot.skeleton.rest)
    for side in "lr":
        posture[robot.skeleton.names.index(f"{side}_elbow_flexion")] = 1.4
        posture[robot.skeleton.names.index(f"{side}_shoulder_flexion")] = 0.5
    return robot.skeleton.clamp(posture)


@pytest.mark.parametrize("part", CHAIN_OF_PART)
def test_dragged_body_part_keeps_joint_limits_and_clearance_and_moves_only_its_joints(upper22_setup, part):
    robot, distances = upper22_setup.robot, upper22_setup.distances
    skeleton, rng, stopped = robot.skeleton, np.random.default_rng(3), set()
    start, joints = raised(robot), robot.joints(CHAIN_OF_PART[part])
    hand = skeleton.frames(start).origins[robot.arm("l").wrist]
    for _ in range(40):
        target = robot.gesture_origin + [0.1, 0.0, 0.3] + robot.arm_length * rng.uniform(-1.5, 1.5, 3)
        posture = drag_part(robot, distances, part, "l", target, start)
        assert ((posture.angles >= skeleton.lower - 1e-9) & (posture.angles <= skeleton.upper + 1e-9)).all()
        assert distances.clearance(posture.angles[None]).distances[0] > robot.min_clearance - 1e-3
        others = [k for k in range(len(start)) if k not in joints]
        assert np.array_equal(posture.angles[others], start[others])
        if part == "elbow":
            moved = skeleton.frames(posture.angles).origins[robot.arm("l").wrist]
            assert np.linalg.norm(moved - hand) < 0.01 * (1 if posture.reached else 3)
        if posture.reached:
            assert (posture.limits, posture.contact) == ((), None)
        else:
            # an elbow also stops where its hand would leave its place
            assert posture.limits or posture.contact or part == "elbow"
            assert {skeleton.names.index(name) for name in posture.limits} <= set(joints)
            stopped |= {"contact"} if posture.contact else {"limits"} if posture.limits else set()
    assert "limits" in stopped


def test_dragged_elbow_reaches_positions_on_its_swivel_circle(upper22_setup):
    robot, start = upper22_setup.robot, raised(upper22_setup.robot)
    arm, frames = robot.arm("l"), robot.skeleton.frames(raised(robot))
    shoulder, elbow, hand = (frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist))
    axis = (hand - shoulder) / np.linalg.norm(hand - shoulder)
    for turn in np.radians((-8.0, 8.0, 15.0)):
        out = elbow - shoulder - axis * (axis @ (elbow - shoulder))
        place = elbow - out + out * np.cos(turn) + np.cross(axis, out) * np.sin(turn)
        posture = drag_part(robot, upper22_setup.distances, "elbow", "l", place, start)
        assert posture.reached
        assert np.linalg.norm(robot.skeleton.frames(posture.angles).origins[arm.elbow] - place) < 0.003


def test_residual_of_an_unreached_elbow_is_its_distance_from_the_target(upper22_setup):
    robot, start = upper22_setup.robot, raised(upper22_setup.robot)
    arm, frames = robot.arm("l"), robot.skeleton.frames(start)
    shoulder, elbow, hand = (frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist))
    axis = (hand - shoulder) / np.linalg.norm(hand - shoulder)
    centre = shoulder + axis * (axis @ (elbow - shoulder))
    opposite = 2.0 * centre - elbow
    found = drag_part(robot, upper22_setup.distances, "elbow", "l", opposite, start)
    assert not found.reached
    reached = robot.skeleton.frames(found.angles).origins[arm.elbow]
    assert found.residual == pytest.approx(np.linalg.norm(reached - opposite), abs=1e-9)


def test_dragged_gaze_reaches_the_target_unless_the_neck_is_at_its_limit(upper22_setup):
    robot, start = upper22_setup.robot, upper22_setup.robot.skeleton.rest
    head, eyes = robot.skeleton.segment("skullbase"), robot.sites["eyes"]
    for target in ([1.0, 0.3, 1.4], [0.8, -0.4, 1.2], [0.5, 0.0, 1.0]):
        posture = drag_part(robot, upper22_setup.distances, "gaze", "r", np.array(target), start)
        assert posture.reached, target
        frames = robot.skeleton.frames(posture.angles)
        way = target - frames.origins[head] - frames.rotations[head] @ eyes.position
        assert np.cross(way / np.linalg.norm(way), frames.rotations[head] @ eyes.facing) == pytest.approx(0, abs=3e-3)
    behind = drag_part(robot, upper22_setup.distances, "gaze", "r", np.array([-1.0, 0.3, 1.4]), start)
    assert "skullbase_torsion" in behind.limits
    assert behind.residual > 0.5


def test_dragged_trunk_reaches_a_near_target_and_names_its_limit_for_a_far_one(upper22_setup):
    robot, start = upper22_setup.robot, upper22_setup.robot.skeleton.rest
    neck = robot.skeleton.segment("skullbase")
    place = robot.skeleton.frames(start).origins[neck] + [0.03, 0.04, 0.0]
    posture = drag_part(robot, upper22_setup.distances, "trunk", "r", place, start)
    assert posture.reached
    assert np.linalg.norm(robot.skeleton.frames(posture.angles).origins[neck] - place) < 0.01
    far = drag_part(robot, upper22_setup.distances, "trunk", "r", place + np.array([0.6, 0.0, -0.1]), start)
    assert not far.reached
    assert "vl5_tilt" in far.limits
