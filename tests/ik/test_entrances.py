"""Tests of the four public functions of inverse kinematics."""

import numpy as np
import pytest

from kinesic import ik
from kinesic.body.robot import Robot
from kinesic.ik.pose import hold_reach, solve_pose
from kinesic.ik.solve import solve
from kinesic.ik.two_hands import reach_both

DEFAULT_ROBOT = Robot.load()
LEFT_ARM = DEFAULT_ROBOT.arms["l"]  # chain of the left arm
HAND_TARGET = np.array([0.28, 0.10, -0.05])  # (3,) [m] in the frame of the arm's base


def test_public_ik_functions_are_not_hidden_by_modules_of_the_same_name():
    assert (ik.solve, ik.pose, ik.hold, ik.two_hands) == (solve, solve_pose, hold_reach, reach_both)
    assert all(callable(getattr(ik, name)) for name in ("solve", "pose", "two_hands", "track"))


def test_tracker_returns_a_posture_before_requesting_the_next_target():
    asked = []

    def targets():
        for k in range(20):
            asked.append(k)
            yield HAND_TARGET + np.array([0.0, 0.002 * k, 0.0])

    following = ik.track(
        LEFT_ARM, targets(), period=0.01, start=ik.solve(LEFT_ARM, ik.Reach(HAND_TARGET), start=LEFT_ARM.rest).angles
    )
    next(following)
    assert asked == [0]
    *_, last = following
    assert np.linalg.norm(LEFT_ARM.hand(last) - HAND_TARGET - [0.0, 0.038, 0.0]) < 1e-5


def test_ik_track_yields_the_same_postures_as_tracker_steps():
    tracker = ik.Tracker(LEFT_ARM, period=0.01)
    targets = [HAND_TARGET + np.array([0.0, 0.0, 0.001 * k]) for k in range(10)]
    result = np.array(list(ik.track(LEFT_ARM, targets, period=0.01)))
    np.testing.assert_array_equal(result, [tracker.step(target) for target in targets])


def test_tracker_rejects_an_invalid_period_before_iteration():
    with pytest.raises(ValueError, match="period is 0"):
        ik.track(LEFT_ARM, iter(()), period=0.0)
