import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import STEP, Trajectory, stay
from kinesic.planning.secondary.drift import LARGEST_DRIFT, LEAST_HOLD, drifts, held_spans

ROBOT = Robot.load()
REST = ROBOT.skeleton.rest
ELBOW = ROBOT.skeleton.names.index("l_elbow_flexion")


def raised(hold, *, hinge=ELBOW):
    """A forearm that goes up in a second, is held, and comes down."""
    times = np.arange(0.0, hold + 3.0, STEP)
    share = minimum_jerk(times - 0.5) - minimum_jerk(times - 1.5 - hold)
    controls = np.tile(REST, (len(times), 1))
    controls[:, hinge] += share
    return Trajectory(sealed(controls), 0.0)


def test_a_hold_is_found_where_the_arm_stands_still():
    ((begin, end),) = held_spans(raised(2.0), "l", ROBOT)
    assert begin == pytest.approx(1.5, abs=0.1)
    assert end == pytest.approx(3.5, abs=0.1)
    assert not [*held_spans(raised(2.0), "r", ROBOT)]


@pytest.mark.parametrize("hold", [0.0, LEAST_HOLD - 0.2])
def test_what_is_hardly_held_does_not_stray(hold):
    assert not [*drifts(raised(hold), 1.0, ROBOT, np.random.default_rng(0))]


def test_an_arm_that_hangs_does_not_stray():
    assert not [*drifts(stay(REST, 10.0), 1.0, ROBOT, np.random.default_rng(0))]


def test_it_strays_within_the_hold_a_little_and_more_than_once_in_a_long_one():
    swells = [*drifts(raised(6.0), 1.0, ROBOT, np.random.default_rng(0))]
    assert len(swells) >= 3
    assert min(swell.begin for swell in swells) >= 1.4
    assert max(swell.end for swell in swells) <= 7.6
    assert 0.0 < max(np.abs(swell.away).max() for swell in swells) <= LARGEST_DRIFT
    moved = np.any([swell.away != 0.0 for swell in swells], axis=0)
    assert {ROBOT.skeleton.names[hinge][:2] for hinge in np.flatnonzero(moved)} == {"l_"}


def test_in_little_time_it_strays_less_far():
    (short,) = drifts(raised(0.6), 1.0, ROBOT, np.random.default_rng(0))
    assert np.abs(short.away).max() <= LARGEST_DRIFT * 0.75
