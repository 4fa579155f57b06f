"""Postures for a dragged hand: arrival, ranges, clearance and obstacles."""

import numpy as np
import pytest

from kinesic.serve.desk.reach import at_limit, reach_posture


@pytest.mark.parametrize("side", ["l", "r"])
def test_dragged_hand_keeps_joint_limits_and_clearance_and_reports_its_distance_from_the_target(upper22_setup, side):
    setup, robot, rng = upper22_setup, upper22_setup.robot, np.random.default_rng(7)
    posture, stopped = robot.skeleton.rest, set()
    for _ in range(60):
        target = robot.gesture_origin + robot.arm_length * rng.uniform(-0.9, 0.9, 3)
        result = reach_posture(robot, setup.distances, side, target, posture)
        hand = robot.skeleton.frames(result.angles).origins[robot.arm(side).wrist]
        assert np.linalg.norm(hand - target) == pytest.approx(result.residual, abs=1e-9)
        assert (result.angles >= robot.skeleton.lower - 1e-9).all()
        assert (result.angles <= robot.skeleton.upper + 1e-9).all()
        assert setup.distances.clearance(result.angles[None]).distances[0] > robot.min_clearance - 1e-3
        others = [k for k in range(len(posture)) if k not in robot.arm(side).joints]
        assert np.array_equal(result.angles[others], posture[others])
        if result.reached:
            assert (result.limits, result.contact) == ((), None)
        else:
            stopped |= {"contact"} if result.contact else {"limits"} if result.limits else {"length"}
            assert all(name.startswith(f"{side}_") for name in result.limits)
        posture = result.angles
    assert stopped >= {"contact", "limits"}


def test_hinges_at_a_limit_are_named_only_for_the_dragged_arm(upper22_setup):
    robot = upper22_setup.robot
    skeleton, joints = robot.skeleton, robot.arm("r").joints
    posture = (skeleton.lower + skeleton.upper) / 2
    first, second, *_ = joints
    posture[first], posture[second] = skeleton.lower[first], skeleton.upper[second]
    other = robot.arm("l").joints[0]
    posture[other] = skeleton.lower[other]
    assert list(at_limit(robot, posture, joints)) == [skeleton.names[first], skeleton.names[second]]
