"""Clearance rounds, notices and refusals of certified motions, on robots of two joints."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bml.block import NoticeType
from kinesic.capture import certification, certified_plan
from kinesic.capture.certification import judge_clip, measure_distance
from kinesic.capture.certified_plan import list_notices, plan_captured
from kinesic.capture.clip import ArmPath
from kinesic.capture.reading.text import CaptureError

from .test_limit_ratios import Still, make_setup, row


def test_captured_motion_is_judged_before_it_is_fitted_to_the_joint_ranges(monkeypatch):
    motion = SimpleNamespace(requested="requested")
    monkeypatch.setattr(certification, "retarget", lambda *inputs: (motion, inputs)[0])
    monkeypatch.setattr(certification, "find_violations", lambda angles, setup: (angles, setup))
    assert judge_clip("clip", "robot", "a.bvh") == (motion, ("requested", "robot"))


@dataclass(frozen=True)
class FakeCourse:
    """Course of a motion whose angles are a name."""

    angles: str

    @classmethod
    def of(cls, angles, setup):
        return cls(angles)


def search_clear(monkeypatch, clearances):
    """Return the detour calls, the stretches given, and the result for clearances of successive rounds.

    Calls with a cost are detours; those with a margin leave contacts out.
    """
    calls, stretches, left = [], [], list(clearances)

    def clear(angles, setup, *, min_clearance, hinge_cost):
        calls.append((min_clearance, hinge_cost))
        return f"{angles} {len(calls)}"

    def bridge(angles, setup, *, min_clearance, margin):
        calls.append((min_clearance, f"{angles} without {margin:g} s"))
        return f"{angles} bridged {margin:g}"

    def nearest(course, setup, stretch):
        stretches.append(stretch)
        motion = SimpleNamespace(trajectory=course.angles)
        return SimpleNamespace(motion=motion, stretch=f"stretch of {course.angles}")

    def scan(trajectory, distances):
        return None, SimpleNamespace(distances=np.array([9.0, left.pop(0)]))

    fakes = {"clear_path": clear, "bridge_contacts": bridge, "find_nearest": nearest, "scan_clearance": scan}
    for name, fake in fakes.items():
        monkeypatch.setattr(certification, name, fake)
    monkeypatch.setattr(certification, "Course", FakeCourse)
    monkeypatch.setattr(certification, "LAG_RESERVE", 0.001)
    found, clearance = certification._find_clear(SimpleNamespace(angles="wave"), make_setup())
    return calls, stretches, (found.motion.trajectory, clearance)


def test_clearance_search_takes_the_first_captured_motion_with_enough_clearance(monkeypatch):
    calls, stretches, found = search_clear(monkeypatch, [0.01])
    assert (calls, stretches, found) == ([(0.011, 0.1)], [None], ("wave 1", 0.01))


def test_each_round_of_the_clearance_search_requires_the_missing_clearance_and_a_margin(monkeypatch):
    calls, stretches, found = search_clear(monkeypatch, [0.006, 0.0099, 0.0101])
    np.testing.assert_allclose(calls, [(0.011, 0.1), (0.017, 0.1), (0.0191, 0.1)])
    assert stretches == [None, "stretch of wave 1", "stretch of wave 2"]
    assert found == ("wave 3", 0.0101)


def test_contacts_that_no_detour_avoids_are_left_out_with_increasing_margin(monkeypatch):
    calls, stretches, found = search_clear(monkeypatch, [-0.01, 0.004, 0.002, -0.02, 0.003, 0.001, 0.008, 0.011])
    assert [cost for _, cost in calls[:6]] == [0.1] * 3 + [10.0] * 3
    assert calls[3][0] == calls[0][0]
    assert calls[6:] == [(0.011, "wave 2 without 0.1 s"), (0.011, "wave 2 without 0.2 s")]
    assert stretches[3:7] == ["stretch of wave 2"] * 4
    assert found == ("wave 2 bridged 0.2", 0.011)


def test_clearance_search_takes_the_motion_with_most_clearance_if_all_rounds_fail(monkeypatch):
    _, _, found = search_clear(monkeypatch, [-0.01, 0.004, 0.002, -0.02, 0.004, 0.003, 0.001, 0.006, 0.0, 0.0, 0.005])
    assert found == ("wave 2 bridged 0.2", 0.006)


def certified(*, stretch=1.0, slowest=1.0, wrist=0.0, notes=()):
    nearest = SimpleNamespace(total_stretch=stretch, stretch=row(1.0, slowest))
    distance = SimpleNamespace(wrist_max=wrist)
    return SimpleNamespace(desired=SimpleNamespace(notes=notes), nearest=nearest, distance=distance)


@pytest.mark.parametrize(
    ("options", "texts"),
    [
        ({}, []),
        ({"notes": ("a guess", "another")}, ["a guess", "another"]),
        ({"stretch": 1.0049, "wrist": 0.0499}, []),
        (
            {"stretch": 1.0051, "slowest": 2.346},
            ["faster than the servos: it lasts 1.01 times as long, and is at most 2.35 times slower"],
        ),
        ({"wrist": 0.0501}, ["a wrist is up to 0.05 arm lengths away from that of the file"]),
    ],
)
def test_notices_of_a_captured_motion_give_guesses_stretch_and_wrist_distance(options, texts):
    notices = list_notices(certified(**options))
    assert [notice.text for notice in notices] == texts
    assert {(notice.type, notice.id) for notice in notices} <= {(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "motion")}


def test_refusal_of_a_captured_motion_gives_its_clearance_ratio_and_duty(monkeypatch):
    values = {"clearance": 0.0042, "limit_ratio": 1.0123, "torque_ratio": 0.876, "setup": make_setup()}
    refused = SimpleNamespace(source="a.bvh", is_certified=False, **values)
    monkeypatch.setattr(certified_plan, "certify_clip", lambda *inputs: refused)
    message = "a.bvh: no .* clearance 4 mm of 10 mm, value / limit 1.012, drive duty 0.88; `kinesic certify` lists"
    with pytest.raises(CaptureError, match=message):
        plan_captured("clip", make_setup(), source="a.bvh")


def test_certification_has_the_largest_duty_of_all_drives_and_the_arm_paths_of_the_file(monkeypatch):
    trajectory = Still(velocities=(0, 3))
    nearest = SimpleNamespace(motion=SimpleNamespace(trajectory=trajectory), angles=row(1, 2))
    desired = SimpleNamespace(arms={"l": "of the file"}, angles="angles")
    without_arms = SimpleNamespace(arms={}, angles="angles")
    monkeypatch.setattr(certification, "find_violations", lambda angles, setup: ())
    monkeypatch.setattr(certification, "_find_clear", lambda motion, setup: (nearest, 0.02))
    monkeypatch.setattr(certification, "compute_peak_duties", lambda *inputs: row(0.2, 0.7))
    monkeypatch.setattr(certification, "arm_paths", lambda robot, angles: {"l": f"of {angles}"})
    monkeypatch.setattr(certification, "measure_distance", lambda arms, *inputs: arms["l"])
    for motion, arm in ((desired, "of the file"), (without_arms, "of angles")):
        motion.requested = "requested"
        monkeypatch.setattr(certification, "retarget", lambda *inputs, motion=motion: motion)
        found = certification.certify_clip("clip", make_setup(speed=row(1, 2)), "a.bvh")
        assert (found.source, found.desired, found.distance) == ("a.bvh", motion, arm)
        assert (found.torque_ratio, found.clearance, found.limit_ratio) == (0.7, 0.02, 1.5)
        assert (found.nearest, found.trajectory) == (nearest, trajectory)


def test_correlation_of_two_hands_is_that_of_the_less_similar_path(monkeypatch):
    rise = np.linspace(0, 1, 9)[:, None] * row(0, 0, 1)
    there_and_back = np.abs(rise - rise[4])
    file = {"l": ArmPath(rise, rise), "r": ArmPath(rise, rise)}
    reached = {"l": ArmPath(rise, rise), "r": ArmPath(rise, rise + 3 * there_and_back)}
    monkeypatch.setattr(certification, "arm_paths", lambda robot, angles: reached)
    found = measure_distance(file, SimpleNamespace(angles=None), make_setup())
    both = np.corrcoef(rise[:, 2], reached["r"].wrist[:, 2])[0, 1]
    assert found.correlation == pytest.approx(both)
    assert found.wrist_max == pytest.approx(1.5)
