import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, stay
from kinesic.planning.secondary.drift import MAX_DRIFT, MIN_HOLD_TIME, find_held_spans, make_drifts

ROBOT = Robot.load()
REST = ROBOT.skeleton.rest
ELBOW = ROBOT.skeleton.names.index("l_elbow_flexion")


def raised(hold, *, hinge=ELBOW):
    """Return a motion with a forearm raised, held and lowered."""
    times = np.arange(0.0, hold + 3.0, KNOT_INTERVAL)
    share = minimum_jerk(times - 0.5) - minimum_jerk(times - 1.5 - hold)
    controls = np.tile(REST, (len(times), 1))
    controls[:, hinge] += share
    return Trajectory(sealed(controls), 0.0)


def test_arm_standing_still_away_from_rest_is_a_hold():
    ((begin, end),) = find_held_spans(raised(2.0), "l", ROBOT)
    assert begin == pytest.approx(1.5, abs=0.1)
    assert end == pytest.approx(3.5, abs=0.1)
    assert not [*find_held_spans(raised(2.0), "r", ROBOT)]


@pytest.mark.parametrize("hold", [0.0, MIN_HOLD_TIME - 0.2])
def test_hand_does_not_drift_during_a_short_hold(hold):
    assert not [*make_drifts(raised(hold), 1.0, ROBOT, np.random.default_rng(0))]


def test_hanging_arm_does_not_drift():
    assert not [*make_drifts(stay(REST, 10.0), 1.0, ROBOT, np.random.default_rng(0))]


def test_arm_drifts_several_times_during_a_long_hold():
    swells = [*make_drifts(raised(6.0), 1.0, ROBOT, np.random.default_rng(0))]
    assert len(swells) >= 3
    assert min(swell.begin for swell in swells) >= 1.4
    assert max(swell.end for swell in swells) <= 7.6
    assert 0.0 < max(np.abs(swell.away).max() for swell in swells) <= MAX_DRIFT
    moved = np.any([swell.away != 0.0 for swell in swells], axis=0)
    assert {ROBOT.skeleton.names[hinge][:2] for hinge in np.flatnonzero(moved)} == {"l_"}


def test_drift_is_smaller_in_short_holds():
    (short,) = make_drifts(raised(0.6), 1.0, ROBOT, np.random.default_rng(0))
    assert np.abs(short.away).max() <= MAX_DRIFT * 0.75
