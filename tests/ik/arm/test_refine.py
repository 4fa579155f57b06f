from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.refine import refine_posture, true_arm
from kinesic.ik.solve import solve

UPPER22 = Robot.load()
AXES = {"l_shoulder_twisting": (0.15, 0.1, 1.0), "l_shoulder_flexion": (0.0, -1.0, 0.3)}
AT = {"l_shoulder_flexion": (0.0, 0.0, 0.02), "l_elbow_flexion": (0.02, 0.0, 0.0), "l_wrist_pivot": (0.01, 0.0, 0.0)}


def crooked() -> Robot:
    """Return the default robot with a left arm whose axes do not intersect."""

    def bent(hinge):
        axis = np.array(AXES.get(hinge.name, hinge.axis))
        return replace(hinge, axis=sealed(axis / np.linalg.norm(axis)), at=sealed(AT.get(hinge.name, (0, 0, 0))))

    skeleton = replace(UPPER22.skeleton, hinges=tuple(bent(hinge) for hinge in UPPER22.skeleton.hinges))
    return replace(UPPER22, skeleton=skeleton)


ROBOT = crooked()
HAND = ROBOT.skeleton.segment("l_wrist")


def test_refinement_does_not_change_an_arm_with_ideal_axes():
    assert true_arm(UPPER22, "l").exact
    rest = UPPER22.skeleton.rest
    assert refine_posture(UPPER22, "l", Reach(np.zeros(3)), rest, near=rest) is rest


def test_arm_geometry_and_jacobians_with_axis_offsets_match_the_skeleton():
    arm, joints = true_arm(ROBOT, "l"), list(ROBOT.joints("l_arm"))
    posture = np.array(ROBOT.skeleton.rest)
    posture[joints] = np.linspace(0.1, 0.8, len(joints))
    points, directions, moves = arm.posture(posture[joints])
    frames = ROBOT.skeleton.frames(posture)
    base = ROBOT.skeleton.segment(ROBOT.arms["l"].base)
    for name, point in zip(("l_elbow", "l_wrist"), points, strict=True):
        inside = frames.rotations[base].T @ (frames.origins[ROBOT.skeleton.segment(name)] - frames.origins[base])
        assert point == pytest.approx(inside, abs=1e-12)
    step = 1e-6 * np.eye(len(joints))
    for k in range(len(joints)):
        ahead = arm.posture(posture[joints] + step[k])
        assert (ahead[0] - points) / 1e-6 == pytest.approx(moves[:2, :, k], abs=1e-5)
        assert (ahead[1] - directions) / 1e-6 == pytest.approx(moves[2:, :, k], abs=1e-5)


def test_arm_with_axis_offsets_reaches_targets_that_the_ideal_solution_misses():
    random = np.random.default_rng(3)
    joints, rest = list(ROBOT.joints("l_arm")), ROBOT.skeleton.rest
    chain = ROBOT.arms["l"]
    base = ROBOT.skeleton.segment(chain.base)
    frames = ROBOT.skeleton.frames(rest)
    missed = []
    for _ in range(20):
        posture = np.array(rest)
        posture[joints] = random.uniform(chain.lower, chain.upper)
        target = ROBOT.skeleton.frames(posture).origins[HAND]
        guess = np.array(rest)
        inside = frames.rotations[base].T @ (target - frames.origins[base])
        guess[list(chain.indices)] = solve(chain, Reach(inside), start=chain.rest).angles
        missed.append(np.linalg.norm(ROBOT.skeleton.frames(guess).origins[HAND] - target))
        refined_posture = refine_posture(ROBOT, "l", Reach(target), guess, near=rest)
        assert np.linalg.norm(ROBOT.skeleton.frames(refined_posture).origins[HAND] - target) < 1e-3
        assert np.all(refined_posture >= ROBOT.skeleton.lower - 1e-12)
        assert np.all(refined_posture <= ROBOT.skeleton.upper + 1e-12)
        others = [k for k in range(len(rest)) if k not in joints]
        assert refined_posture[others] == pytest.approx(rest[others])
    assert np.median(missed) > 0.01


def test_refinement_turns_the_palm_towards_a_requested_direction():
    rest = ROBOT.skeleton.rest
    target = ROBOT.gesture_origin + ROBOT.arm_length * np.array([0.6, 0.3, 0.3])
    plain = refine_posture(ROBOT, "l", Reach(target), rest, near=rest)
    led = refine_posture(ROBOT, "l", Reach(target, palm=np.array([0.0, 0.0, 1.0])), rest, near=rest)
    facing = [ROBOT.skeleton.frames(a).rotations[HAND] @ ROBOT.sites["l_palm"].facing for a in (plain, led)]
    assert facing[1][2] > facing[0][2] + 0.3
