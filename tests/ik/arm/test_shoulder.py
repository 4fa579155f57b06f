import numpy as np
import pytest

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.shoulder import carry_shoulder
from kinesic.ik.solve import solve

ROBOT = Robot.load()
ARM = ROBOT.arms["l"]
HIGH, LOW = np.array([0.25, 0.2, 0.2]), np.array([0.25, 0.2, -0.2])


def test_without_effort_the_shoulder_stays():
    assert carry_shoulder(ARM, HIGH, 0.0) is ARM.rest


@pytest.mark.parametrize(("target", "sign"), [(HIGH, 1.0), (LOW, -1.0)])
def test_more_effort_takes_the_shoulder_further_towards_the_hand(target, sign):
    followed = [sign * (carry_shoulder(ARM, target, effort)[0] - ARM.rest[0]) for effort in (0.0, 0.3, 0.6, 1.0)]
    assert followed == sorted(followed)
    assert followed[-1] > np.radians(5)
    np.testing.assert_array_equal(carry_shoulder(ARM, target, 1.0)[1:], ARM.rest[1:])


def test_an_arm_that_is_stretched_pulls_harder():
    shoulder = ARM.frames(ARM.rest)[1][1]
    near, far = (carry_shoulder(ARM, shoulder + share * (HIGH - shoulder), 0.5)[0] for share in (0.5, 0.9))
    assert far > near > 0.0


def test_the_ranges_hold_and_the_hand_stays():
    for target in (HIGH, LOW, np.array([0.0, 0.9, 2.0])):
        rest = carry_shoulder(ARM, target, 1.0)
        assert np.all((ARM.lower <= rest) & (rest <= ARM.upper))
    pulled = solve(ARM, Reach(HIGH), start=ARM.rest, rest=carry_shoulder(ARM, HIGH, 1.0))
    assert pulled.residual < 1e-6
    assert pulled.angles[0] == pytest.approx(carry_shoulder(ARM, HIGH, 1.0)[0])


def test_the_right_shoulder_mirrors_the_left():
    flip = np.array([1.0, -1.0, 1.0])
    np.testing.assert_array_equal(carry_shoulder(ROBOT.arms["r"], HIGH * flip, 0.7), carry_shoulder(ARM, HIGH, 0.7))
