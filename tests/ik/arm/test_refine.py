from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.refine import refine_posture, true_arm
from kinesic.ik.solve import solve

DEFAULT_ROBOT = Robot.load()
# hinge axes that do not intersect at the shoulder
TILTED_AXES = {"l_shoulder_twisting": (0.15, 0.1, 1.0), "l_shoulder_flexion": (0.0, -1.0, 0.3)}
# [m] offsets of hinges from their joint's centre
HINGE_OFFSETS = {
    "l_shoulder_flexion": (0.0, 0.0, 0.02),
    "l_elbow_flexion": (0.02, 0.0, 0.0),
    "l_wrist_pivot": (0.01, 0.0, 0.0),
}


def crooked() -> Robot:
    """Return the default robot with non-intersecting axes of the left arm."""

    def bent(hinge):
        axis = np.array(TILTED_AXES.get(hinge.name, hinge.axis))
        return replace(
            hinge, axis=sealed(axis / np.linalg.norm(axis)), at=sealed(HINGE_OFFSETS.get(hinge.name, (0, 0, 0)))
        )

    skeleton = replace(DEFAULT_ROBOT.skeleton, hinges=tuple(bent(hinge) for hinge in DEFAULT_ROBOT.skeleton.hinges))
    return replace(DEFAULT_ROBOT, skeleton=skeleton)


CROOKED_ROBOT = crooked()  # robot with a left arm whose axes do not intersect
WRIST_SEGMENT = CROOKED_ROBOT.skeleton.segment("l_wrist")  # index of the wrist's segment


def test_ik_refinement_does_not_change_the_posture_of_an_arm_with_ideal_axes():
    assert true_arm(DEFAULT_ROBOT, "l").exact
    rest = DEFAULT_ROBOT.skeleton.rest
    assert refine_posture(DEFAULT_ROBOT, "l", Reach(np.zeros(3)), rest, near=rest) is rest


def test_arm_geometry_and_jacobians_with_axis_offsets_match_the_skeleton():
    arm, joints = true_arm(CROOKED_ROBOT, "l"), list(CROOKED_ROBOT.joints("l_arm"))
    posture = np.array(CROOKED_ROBOT.skeleton.rest)
    posture[joints] = np.linspace(0.1, 0.8, len(joints))
    points, directions, moves = arm.posture(posture[joints])
    frames = CROOKED_ROBOT.skeleton.frames(posture)
    base = CROOKED_ROBOT.skeleton.segment(CROOKED_ROBOT.arms["l"].base)
    for name, point in zip(("l_elbow", "l_wrist"), points, strict=True):
        inside = frames.rotations[base].T @ (
            frames.origins[CROOKED_ROBOT.skeleton.segment(name)] - frames.origins[base]
        )
        assert point == pytest.approx(inside, abs=1e-12)
    step = 1e-6 * np.eye(len(joints))
    for k in range(len(joints)):
        ahead = arm.posture(posture[joints] + step[k])
        assert (ahead[0] - points) / 1e-6 == pytest.approx(moves[:2, :, k], abs=1e-5)
        assert (ahead[1] - directions) / 1e-6 == pytest.approx(moves[2:, :, k], abs=1e-5)


def test_arm_with_axis_offsets_reaches_targets_that_the_ideal_solution_misses():
    random = np.random.default_rng(3)
    joints, rest = list(CROOKED_ROBOT.joints("l_arm")), CROOKED_ROBOT.skeleton.rest
    chain = CROOKED_ROBOT.arms["l"]
    base = CROOKED_ROBOT.skeleton.segment(chain.base)
    frames = CROOKED_ROBOT.skeleton.frames(rest)
    missed = []
    for _ in range(20):
        posture = np.array(rest)
        posture[joints] = random.uniform(chain.lower, chain.upper)
        target = CROOKED_ROBOT.skeleton.frames(posture).origins[WRIST_SEGMENT]
        guess = np.array(rest)
        inside = frames.rotations[base].T @ (target - frames.origins[base])
        guess[list(chain.indices)] = solve(chain, Reach(inside), start=chain.rest).angles
        missed.append(np.linalg.norm(CROOKED_ROBOT.skeleton.frames(guess).origins[WRIST_SEGMENT] - target))
        refined_posture = refine_posture(CROOKED_ROBOT, "l", Reach(target), guess, near=rest)
        assert np.linalg.norm(CROOKED_ROBOT.skeleton.frames(refined_posture).origins[WRIST_SEGMENT] - target) < 1e-3
        assert np.all(refined_posture >= CROOKED_ROBOT.skeleton.lower - 1e-12)
        assert np.all(refined_posture <= CROOKED_ROBOT.skeleton.upper + 1e-12)
        others = [k for k in range(len(rest)) if k not in joints]
        assert refined_posture[others] == pytest.approx(rest[others])
    assert np.median(missed) > 0.01


def test_ik_refinement_turns_the_palm_towards_a_requested_direction():
    rest = CROOKED_ROBOT.skeleton.rest
    target = CROOKED_ROBOT.gesture_origin + CROOKED_ROBOT.arm_length * np.array([0.6, 0.3, 0.3])
    plain = refine_posture(CROOKED_ROBOT, "l", Reach(target), rest, near=rest)
    led = refine_posture(CROOKED_ROBOT, "l", Reach(target, palm=np.array([0.0, 0.0, 1.0])), rest, near=rest)
    facing = [
        CROOKED_ROBOT.skeleton.frames(a).rotations[WRIST_SEGMENT] @ CROOKED_ROBOT.sites["l_palm"].facing
        for a in (plain, led)
    ]
    assert facing[1][2] > facing[0][2] + 0.3
