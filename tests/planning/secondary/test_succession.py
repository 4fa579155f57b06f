from dataclasses import replace

import numpy as np
import pytest

from kinesic.expressivity.keyframes import Succession
from kinesic.expressivity.variation import Variation
from kinesic.motion.limit_check import check_limits
from kinesic.planning.certify import MAX_DUTY, compute_peak_duties
from kinesic.planning.secondary.arm_times import find_arm_courses
from kinesic.planning.secondary.changes import Changes
from kinesic.planning.secondary.succession import _spline, delay_hinges
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
# two-handed gesture, and the time until its delayed end
LARGE_GESTURE = '<gesture id="g" lexeme="large" start="1" stroke="2.4" relax="3.4" end="5"/><wait id="w" duration="6"/>'
HAND_DELAY = 0.05  # [s] delay of the following hand
JOINT_DELAY = 0.06  # [s] delay from shoulder to wrist


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.fixture(scope="module")
def exact(known):
    """Plan a gesture of both hands without delay."""
    return plan(BML_TEMPLATE.format(LARGE_GESTURE), known)


@pytest.mark.parametrize("count", [4, 5, 8, 60])
def test_spline_for_delayed_joints_matches_scipy(count: int):
    interpolate = pytest.importorskip("scipy.interpolate", reason="SciPy, the oracle of this test, is not installed")
    rng = np.random.default_rng(count)
    points, places = rng.normal(size=(count, 3)), rng.uniform(0.0, count - 1.0, 50)
    other = interpolate.CubicSpline(np.arange(count), points)
    np.testing.assert_allclose(_spline(points).at(places), other(places), atol=1e-12)


def laid(exact, succession):
    frames = replace(exact.keyframes, successions={"g": succession})
    courses = find_arm_courses(frames, exact.motion, exact.setup.robot)
    results = [*delay_hinges(courses, exact.trajectory, exact.setup.robot)]
    return Changes(exact.trajectory, results).added(np.ones(len(results)))


def at(trajectory, times, joints):
    return trajectory.sample(trajectory.zero + np.asarray(times))[0][:, list(joints)]


def planned(exact, sync):
    return exact.syncs[f"g:{sync}"].planned


def test_only_the_following_hand_of_a_two_handed_gesture_is_delayed(exact):
    robot, late = exact.setup.robot, laid(exact, Succession("r", HAND_DELAY))
    times = np.linspace(planned(exact, "start") + HAND_DELAY, planned(exact, "end") + 2 * HAND_DELAY, 60)
    left, right = (robot.arm(side).joints for side in "lr")
    np.testing.assert_allclose(at(late, times, left), at(exact.trajectory, times - HAND_DELAY, left), atol=1e-4)
    np.testing.assert_allclose(at(late, times, right), at(exact.trajectory, times, right), atol=1e-9)
    assert np.abs(at(late, times, left) - at(exact.trajectory, times, left)).max() > np.radians(3)


def test_wrist_lags_behind_the_shoulder_on_the_return_but_not_in_the_stroke(exact):
    robot, loose = exact.setup.robot, laid(exact, Succession("r", 0.0, JOINT_DELAY))
    stroke = np.linspace(planned(exact, "strokeStart"), planned(exact, "strokeEnd"), 20)
    home = np.linspace(planned(exact, "relax") + 0.1, planned(exact, "end") - 0.1, 40)
    for side in "lr":
        arm = robot.arm(side)
        np.testing.assert_allclose(at(loose, stroke, arm.joints), at(exact.trajectory, stroke, arm.joints), atol=1e-6)
        shoulder, elbow, wrist = arm.joints[1:4], arm.joints[4:6], arm.joints[6:]
        for joints, late in ((shoulder, -JOINT_DELAY / 2), (elbow, 0.0), (wrist, JOINT_DELAY / 2)):
            np.testing.assert_allclose(at(loose, home, joints), at(exact.trajectory, home - late, joints), atol=2e-4)
    assert loose.end == pytest.approx(exact.trajectory.end, abs=0.1)


def test_wrist_lags_during_preparation_and_arrives_in_time(exact):
    loose, wrist = laid(exact, Succession("r", 0.0, JOINT_DELAY)), exact.setup.robot.arm("r").joints[6:]
    begin, end = planned(exact, "start"), planned(exact, "strokeStart")
    soon = begin + 0.25 * (end - begin)
    went, goes = (np.abs(at(t, [soon], wrist) - at(t, [begin - 0.1], wrist)) for t in (exact.trajectory, loose))
    assert goes.max() < 0.9 * went.max()
    np.testing.assert_allclose(at(loose, [end], wrist), at(exact.trajectory, [end], wrist), atol=1e-6)


def test_gestures_without_random_delays_get_no_hinge_delays(exact):
    courses = find_arm_courses(exact.keyframes, exact.motion, exact.setup.robot)
    assert not [*delay_hinges(courses, exact.trajectory, exact.setup.robot)]
    assert not np.any(laid(exact, Succession("r")).controls != exact.trajectory.controls)


def test_hand_and_joint_delays_keep_limits_torques_and_distances(known):
    varied = plan(BML_TEMPLATE.format(LARGE_GESTURE), replace(known, variation=Variation(1.0, 3)))
    assert varied.keyframes.successions["g"].behind > 0.0
    peaks = check_limits(varied.trajectory, known.limits).by_quantity.values()
    assert all(peak.ratios.max() <= 1.0 + 1e-6 for peak in peaks)
    assert compute_peak_duties(varied.trajectory, known).max() <= MAX_DUTY
    assert varied.clearance.distances.min() >= known.robot.min_clearance
