from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.keyframes import Succession
from kinesic.expressivity.variation import Variation
from kinesic.motion.limit_check import check_limits
from kinesic.planning.certify import FULL, duties
from kinesic.planning.secondary.arm_times import arm_courses
from kinesic.planning.secondary.changes import Changes
from kinesic.planning.secondary.succession import later_hinges

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
LARGE = '<gesture id="g" lexeme="large" start="1" stroke="2.4" relax="3.4" end="5"/><wait id="w" duration="6"/>'
BEHIND, LOOSE = 0.05, 0.06


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.fixture(scope="module")
def exact(known):
    """Both hands, which move as one."""
    return plan(ROOT.format(LARGE), known)


def laid(exact, succession):
    frames = replace(exact.keyframes, successions={"g": succession})
    courses = arm_courses(frames, exact.motion, exact.setup.robot)
    found = [*later_hinges(courses, exact.trajectory, exact.setup.robot)]
    return Changes(exact.trajectory, found).added(np.ones(len(found)))


def at(trajectory, times, joints):
    return trajectory.sample(trajectory.zero + np.asarray(times))[0][:, list(joints)]


def planned(exact, sync):
    return exact.syncs[f"g:{sync}"].planned


def test_the_hand_that_follows_does_all_of_it_later_and_the_other_one_nothing(exact):
    robot, late = exact.setup.robot, laid(exact, Succession("r", BEHIND))
    times = np.linspace(planned(exact, "start") + BEHIND, planned(exact, "end") + 2 * BEHIND, 60)
    left, right = (robot.arm(side).joints for side in "lr")
    np.testing.assert_allclose(at(late, times, left), at(exact.trajectory, times - BEHIND, left), atol=1e-4)
    np.testing.assert_allclose(at(late, times, right), at(exact.trajectory, times, right), atol=1e-9)
    assert np.abs(at(late, times, left) - at(exact.trajectory, times, left)).max() > np.radians(3)


def test_shoulders_lead_and_wrists_lag_on_the_way_home_and_the_stroke_is_exact(exact):
    robot, loose = exact.setup.robot, laid(exact, Succession("r", 0.0, LOOSE))
    stroke = np.linspace(planned(exact, "strokeStart"), planned(exact, "strokeEnd"), 20)
    home = np.linspace(planned(exact, "relax") + 0.1, planned(exact, "end") - 0.1, 40)
    for side in "lr":
        arm = robot.arm(side)
        np.testing.assert_allclose(at(loose, stroke, arm.joints), at(exact.trajectory, stroke, arm.joints), atol=1e-6)
        shoulder, elbow, wrist = arm.joints[1:4], arm.joints[4:6], arm.joints[6:]
        for joints, late in ((shoulder, -LOOSE / 2), (elbow, 0.0), (wrist, LOOSE / 2)):
            np.testing.assert_allclose(at(loose, home, joints), at(exact.trajectory, home - late, joints), atol=2e-4)
    assert loose.end == pytest.approx(exact.trajectory.end, abs=0.1)


def test_on_the_way_there_a_wrist_is_late_but_comes_in_time(exact):
    loose, wrist = laid(exact, Succession("r", 0.0, LOOSE)), exact.setup.robot.arm("r").joints[6:]
    begin, end = planned(exact, "start"), planned(exact, "strokeStart")
    soon = begin + 0.25 * (end - begin)
    went, goes = (np.abs(at(t, [soon], wrist) - at(t, [begin - 0.1], wrist)) for t in (exact.trajectory, loose))
    assert goes.max() < 0.9 * went.max()
    np.testing.assert_allclose(at(loose, [end], wrist), at(exact.trajectory, [end], wrist), atol=1e-6)


def test_what_moves_together_has_no_changes(exact):
    courses = arm_courses(exact.keyframes, exact.motion, exact.setup.robot)
    assert not [*later_hinges(courses, exact.trajectory, exact.setup.robot)]
    assert not np.any(laid(exact, Succession("r")).controls != exact.trajectory.controls)


def test_what_varies_keeps_limits_torques_and_distances(known):
    varied = plan(ROOT.format(LARGE), replace(known, variation=Variation(1.0, 3)))
    assert varied.keyframes.successions["g"].behind > 0.0
    peaks = check_limits(varied.trajectory, known.limits).shares.values()
    assert all(peak.ratios.max() <= 1.0 + 1e-6 for peak in peaks)
    assert duties(varied.trajectory, known).max() <= FULL
    assert varied.clearance.distances.min() >= known.robot.least_clearance
