"""Tests of planning without a robot, by public names of `kinesic.motion`."""

import numpy as np
import pytest

from kinesic import motion

BOX_LIMITS = {  # limits of two hinges [rad, rad/s, rad/s^2, rad/s^3]
    "lower": np.array([-1.5, -0.2]),
    "upper": np.array([1.5, 2.4]),
    "speed": np.array([2.0, 3.0]),
    "acceleration": np.array([8.0, 12.0]),
    "jerk": np.array([200.0, 300.0]),
}


def test_motion_planned_by_the_public_functions_keeps_limits_and_passes_keys():
    limits = motion.Limits.box(**BOX_LIMITS)
    rows = ((0.0, [0.0, 0.0]), (0.5, [1.2, 2.0]), (2.5, [-0.4, 0.3]), (3.5, [0.0, 0.0]))
    keys = tuple(motion.KeyPosture.whole(time, angles) for time, angles in rows)
    conditioned = motion.condition(keys, limits)
    shares = motion.check_limits(conditioned.trajectory, limits).by_quantity
    assert all(float(peak.ratios.max()) <= 1.0 + 1e-6 for peak in shares.values())
    assert float(shares["duty"].ratios.max()) < 1e-5  # no drive is known
    passed = conditioned.trajectory.sample(conditioned.planned + conditioned.trajectory.zero)[0]
    np.testing.assert_allclose(passed, [angles for _, angles in rows], atol=1e-6)
    assert conditioned.bottlenecks  # the second key comes too soon after the first


def test_key_posture_of_all_hinges_copies_the_given_angles():
    angles = np.zeros(3)
    key = motion.KeyPosture.whole(1.0, angles)
    angles[0] = 1.0
    assert key.angles.tolist() == [0.0, 0.0, 0.0]
    assert key.keyed == (True, True, True)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"speed": np.array([2.0])}, "one number per hinge"),
        ({"lower": np.array([-1.5, 3.0])}, "must be below upper"),
        ({"jerk": np.array([200.0, 0.0])}, "jerk is .* above 0"),
        ({"acceleration": np.array([np.inf, 1.0])}, "acceleration is .* finite"),
    ],
)
def test_invalid_limits_raise_an_error_with_the_reason(wrong, said):
    with pytest.raises(ValueError, match=said):
        motion.Limits.box(**(BOX_LIMITS | wrong))
