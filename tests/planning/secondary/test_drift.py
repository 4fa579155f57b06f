import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, stay
from kinesic.planning.secondary.drift import (
    MAX_DRIFT,
    MAX_TOUCH_DRIFT,
    MIN_HOLD_TIME,
    find_held_spans,
    make_drifts,
)

DEFAULT_ROBOT = Robot.load()
REST_ANGLES = DEFAULT_ROBOT.skeleton.rest  # (n,) [rad] rest posture
ELBOW_HINGE = DEFAULT_ROBOT.skeleton.names.index("l_elbow_flexion")  # index of the left elbow's hinge


def raised(hold, *, hinge=ELBOW_HINGE):
    """Return a motion with a forearm raised, held and lowered."""
    times = np.arange(0.0, hold + 3.0, KNOT_INTERVAL)
    share = minimum_jerk(times - 0.5) - minimum_jerk(times - 1.5 - hold)
    controls = np.tile(REST_ANGLES, (len(times), 1))
    controls[:, hinge] += share
    return Trajectory(sealed(controls), 0.0)


def test_arm_standing_still_away_from_rest_counts_as_a_hold():
    ((begin, end),) = find_held_spans(raised(2.0), "l", DEFAULT_ROBOT)
    assert begin == pytest.approx(1.5, abs=0.1)
    assert end == pytest.approx(3.5, abs=0.1)
    assert not [*find_held_spans(raised(2.0), "r", DEFAULT_ROBOT)]


@pytest.mark.parametrize("hold", [0.0, MIN_HOLD_TIME - 0.2])
def test_hand_does_not_drift_during_a_short_hold(hold):
    assert not [*make_drifts(raised(hold), 1.0, DEFAULT_ROBOT, np.random.default_rng(0))]


def test_hanging_arm_does_not_drift():
    assert not [*make_drifts(stay(REST_ANGLES, 10.0), 1.0, DEFAULT_ROBOT, np.random.default_rng(0))]


def test_arm_drifts_several_times_during_a_long_hold():
    swells = [*make_drifts(raised(6.0), 1.0, DEFAULT_ROBOT, np.random.default_rng(0))]
    assert len(swells) >= 3
    assert min(swell.begin for swell in swells) >= 1.4
    assert max(swell.end for swell in swells) <= 7.6
    assert all(0.4 <= (swell.peak - swell.begin) / (swell.end - swell.begin) <= 0.6 for swell in swells)
    assert 0.5 * MAX_DRIFT < max(np.abs(swell.away).max() for swell in swells) <= MAX_DRIFT
    moved = np.any([swell.away != 0.0 for swell in swells], axis=0)
    assert {DEFAULT_ROBOT.skeleton.names[hinge][:2] for hinge in np.flatnonzero(moved)} == {"l_"}


def test_drift_of_a_held_arm_is_smaller_in_short_holds():
    (short,) = make_drifts(raised(0.6), 1.0, DEFAULT_ROBOT, np.random.default_rng(0))
    assert np.abs(short.away).max() <= MAX_DRIFT * 0.75


def test_touching_hand_drifts_less_than_a_free_one():
    def largest(touching):
        bumps = make_drifts(raised(6.0), 1.0, DEFAULT_ROBOT, np.random.default_rng(0), touching)
        return max(np.abs(bump.away).max() for bump in bumps)

    assert largest({"l": [3.0]}) <= MAX_TOUCH_DRIFT < 0.5 * MAX_DRIFT < largest({"r": [3.0], "l": [20.0]})


def test_held_free_hand_drifts_without_standstills_over_0_6_s():
    motion = raised(4.0)
    bumps = [*make_drifts(motion, 1.0, DEFAULT_ROBOT, np.random.default_rng(1))]
    times = np.linspace(1.8, 5.2, 341)
    offsets = np.sum([bump.fractions_at(times)[:, None] * bump.away for bump in bumps], axis=0)
    speed = np.abs(np.diff(offsets, axis=0)).max(axis=1) / 0.01
    is_still = (speed < np.radians(0.5)).astype(int)
    longest = max(map(len, "".join(map(str, is_still)).split("0")))
    assert longest < 60


def test_arm_at_a_joint_limit_drifts_away_from_it():
    limit = raised(6.0, hinge=DEFAULT_ROBOT.skeleton.names.index("l_wrist_flexion"))
    at_limit = Trajectory(sealed(np.minimum(limit.controls, DEFAULT_ROBOT.skeleton.upper)), 0.0)
    for bump in make_drifts(at_limit, 1.0, DEFAULT_ROBOT, np.random.default_rng(0)):
        angles = at_limit.sample(np.array([bump.begin]))[0][0] + bump.away
        assert np.all(angles <= DEFAULT_ROBOT.skeleton.upper + 1e-9)
