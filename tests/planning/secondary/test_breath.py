from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.planning.secondary.breath import LIFT, breaths

ROBOT = Robot.load()
NAMES = ROBOT.skeleton.names


def found(span, amount=1.0, seed=3, robot=ROBOT):
    return [*breaths(span, amount, robot, np.random.default_rng(seed))]


def of(swells, name):
    return [swell for swell in swells if swell.away[NAMES.index(name)]]


def test_it_breathes_as_people_do():
    trunk = of(found((0.0, 60.6)), "vl5_tilt")
    assert 0.2 <= len(trunk) / 60.0 <= 0.3
    assert all(a.end == b.begin for a, b in pairwise(trunk)), "one breath after the other"
    assert all(np.radians(0.6) < -swell.away[NAMES.index("vl5_tilt")] <= np.radians(1.0) for swell in trunk)


def test_the_face_stays_level_and_the_collar_bones_rise_a_little():
    swells = found((0.0, 20.0))
    for swell in of(swells, "vl5_tilt"):
        assert swell.away[NAMES.index("skullbase_tilt")] == pytest.approx(-swell.away[NAMES.index("vl5_tilt")])
    for side in "lr":
        rises = [swell.away[NAMES.index(f"{side}_sternoclavicular_abduct")] for swell in swells]
        assert 0.6 * LIFT < max(rises) <= LIFT


def test_a_short_span_is_no_breath():
    assert not found((0.0, 2.9))
    assert found((0.0, 3.1))


def test_it_ends_where_the_span_does():
    swells = found((2.0, 30.0))
    assert min(swell.begin for swell in swells) > 2.0
    assert max(swell.end for swell in swells) < 30.0


def test_twice_as_much_is_twice_as_far():
    for one, two in zip(found((0.0, 20.0)), found((0.0, 20.0), 2.0), strict=True):
        np.testing.assert_allclose(two.away, 2.0 * one.away)
