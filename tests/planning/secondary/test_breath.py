from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.planning.secondary.breath import MAX_COLLAR_BONE_LIFT, make_breaths

DEFAULT_ROBOT = Robot.load()
HINGE_NAMES = DEFAULT_ROBOT.skeleton.names


def found(span, amount=1.0, seed=3, robot=DEFAULT_ROBOT):
    return [*make_breaths(span, amount, robot, np.random.default_rng(seed))]


def of(swells, name):
    return [swell for swell in swells if swell.away[HINGE_NAMES.index(name)]]


def test_breathing_rate_is_12_to_18_breaths_per_minute():
    trunk = of(found((0.0, 60.6)), "vl5_tilt")
    assert 0.2 <= len(trunk) / 60.0 <= 0.3
    assert all(a.end == b.begin for a, b in pairwise(trunk)), "one breath after the other"
    assert all(np.radians(0.6) < -swell.away[HINGE_NAMES.index("vl5_tilt")] <= np.radians(1.0) for swell in trunk)


def test_breath_keeps_face_level_and_lifts_collar_bones():
    swells = found((0.0, 20.0))
    for swell in of(swells, "vl5_tilt"):
        assert swell.away[HINGE_NAMES.index("skullbase_tilt")] == pytest.approx(
            -swell.away[HINGE_NAMES.index("vl5_tilt")]
        )
    for side in "lr":
        rises = [swell.away[HINGE_NAMES.index(f"{side}_sternoclavicular_abduct")] for swell in swells]
        assert 0.6 * MAX_COLLAR_BONE_LIFT < max(rises) <= MAX_COLLAR_BONE_LIFT


def test_breathing_motion_is_omitted_in_spans_below_3_s():
    assert not found((0.0, 2.9))
    assert found((0.0, 3.1))


def test_breathing_motion_stays_inside_its_time_span():
    swells = found((2.0, 30.0))
    assert min(swell.begin for swell in swells) > 2.0
    assert max(swell.end for swell in swells) < 30.0


def test_breathing_motion_is_proportional_to_its_amount():
    for one, two in zip(found((0.0, 20.0)), found((0.0, 20.0), 2.0), strict=True):
        np.testing.assert_allclose(two.away, 2.0 * one.away)
