"""Rules by which a motion is led around the body and conditioned again."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.arrays import sealed
from kinesic.body.dynamics import Clearance
from kinesic.motion.keys import KeyPosture
from kinesic.motion.trajectory import stay
from kinesic.planning import clearance, detour
from kinesic.planning.certify import certify
from kinesic.planning.clearance import (
    EASIER,
    LAG_RESERVE,
    LEAST_RESERVE,
    REPAIR,
    TOGETHER,
    culprits,
    keep_clear,
    scan_clearance,
)
from kinesic.planning.detour import GAIN, PLAINLY, PostureCourse, lead_around
from kinesic.planning.plan import plan_block
from kinesic.planning.postures import Postures

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
BEATS = "".join(f'<gesture id="g{k}" lexeme="beat" mode="RIGHT_HAND" stroke="{1 + 4 * k}"/>' for k in range(3))
HAND = ("humanoid_root", "r_wrist")


@pytest.fixture(scope="module")
def beats(known):
    return plan_block(parse(ROOT.format(BEATS)), known)


def test_motion_is_scanned_from_its_start_to_its_very_end(beats, known):
    trajectory = beats.trajectory
    times, found = scan_clearance(trajectory, known.distances)
    assert (times[0], times[-1]) == (trajectory.start, trajectory.start + trajectory.duration)
    assert np.diff(times)[:-1] == pytest.approx(0.01)
    assert 0.0 < times[-1] - times[-2] <= 0.01 + 1e-9
    np.testing.assert_allclose(found.distances, known.distances.clearance(trajectory.angles(times)).distances)


def blamed(made, gaps: dict[float, float]) -> dict[str, str]:
    """Behaviours that are blamed for gaps [m] above the least clearance, by the times [s] of the block."""
    least, zero = made.setup.robot.least_clearance, made.trajectory.zero
    close = Clearance(np.array([least + gap for gap in gaps.values()]), [HAND] * len(gaps))
    return culprits(made.keyframes, made.motion, np.array([*gaps]) + zero, close, made.setup.robot)


def test_behaviour_that_keeps_most_of_the_reserve_is_not_blamed(beats):
    assert blamed(beats, {1.0: 1.01 * LEAST_RESERVE}) == {}
    assert blamed(beats, {1.0: 0.99 * LEAST_RESERVE}).keys() == {"g0"}


def test_worst_of_near_times_counts_and_times_far_from_it_count_themselves(beats):
    least = beats.setup.robot.least_clearance
    found = blamed(beats, {1.0: -0.004, 1.2: -0.007, 5.0: -0.001, 9.0: 0.1})
    assert found == {
        "g0": f"brings {HAND[0]} within {1000 * (least - 0.007):.0f} mm of {HAND[1]} at 1.20 s",
        "g1": f"brings {HAND[0]} within {1000 * (least - 0.001):.0f} mm of {HAND[1]} at 5.00 s",
    }
    assert list(blamed(beats, {1.0: -0.001, 5.0: -0.007})) == ["g1", "g0"]
    near = {3.0: -0.009, 3.0 + 0.9 * TOGETHER: -0.001, 3.0 - 0.9 * TOGETHER: -0.001}
    assert len(blamed(beats, near)) == 1


def test_nothing_moves_and_nothing_is_blamed(known):
    empty = plan_block(parse(ROOT.format("")), known)
    assert culprits(empty.keyframes, empty.motion, np.zeros(1), Clearance(np.zeros(1), [HAND]), known.robot) == {}


@pytest.fixture
def asked(known):
    """Two keys at rest and one of the right arm, which 0.2 m never keep clear."""
    angles = known.robot.skeleton.rest.copy()
    angles[known.robot.arm("r").joints[3]] -= 0.3
    keys = tuple(
        KeyPosture.whole(float(k), sealed(a))
        for k, a in enumerate((known.robot.skeleton.rest, angles, known.robot.skeleton.rest))
    )
    return Postures(keys, {}), replace(known, robot=replace(known.robot, least_clearance=0.2))


@pytest.fixture
def watched(monkeypatch):
    """Courses that were led around, the clearance that they should keep, and the ease of each motion."""
    courses, eases = [], []

    def around(course, *, least, distances, known):
        courses.append((course, least))
        return course

    def conditioned(keys, setup, bonds=(), /, *, ease=1.0, **more):
        eases.append(ease)
        return certify(keys, setup, bonds, ease=ease)

    monkeypatch.setattr(clearance, "lead_around", around)
    return courses, eases, conditioned


@pytest.mark.parametrize("repairs", [0, 1, 2])
def test_motion_that_no_detour_helps_gets_more_time_each_time(asked, watched, repairs: int):
    solved, setup = asked
    courses, eases, conditioned = watched
    postures, motion, times, found = keep_clear(solved, setup, conditioned=conditioned, repairs=repairs)
    assert eases == pytest.approx([EASIER**k for k in range(repairs + 1)])
    assert [course.stray is None for course, _ in courses] == [True] + [False] * repairs
    assert courses[0][1] == pytest.approx(0.2 + LAG_RESERVE)
    assert postures.postures == solved.postures
    np.testing.assert_allclose(found.distances, setup.distances.clearance(motion.trajectory.angles(times)).distances)
    if repairs == 2:
        first, second = courses[1][1], courses[2][1]
        assert first == pytest.approx(0.2 + LAG_RESERVE)
        assert second > 0.2 + LAG_RESERVE + 0.1 + REPAIR


def test_detour_that_changes_something_gets_no_more_time(asked, watched, monkeypatch):
    solved, setup = asked
    _, eases, conditioned = watched

    def around(course, **more):
        return replace(course, postures=tuple(replace(each, time=each.time + 0.001) for each in course.postures))

    monkeypatch.setattr(clearance, "lead_around", around)
    postures, *_ = keep_clear(solved, setup, conditioned=conditioned, repairs=2)
    assert eases == [1.0, 1.0, 1.0]
    assert [each.time for each in postures.postures] == pytest.approx([0.003, 1.003, 2.003])


def test_clear_motion_is_conditioned_once(asked, watched, known):
    solved, _ = asked
    courses, eases, conditioned = watched
    keep_clear(solved, replace(known, robot=replace(known.robot, least_clearance=0.0)), conditioned=conditioned)
    assert (len(courses), eases) == (1, [1.0])


def test_single_posture_is_no_motion(known):
    solved = Postures((KeyPosture.whole(0.0, known.robot.skeleton.rest),), {})
    postures, motion, times, _ = keep_clear(solved, known)
    assert postures is solved
    np.testing.assert_allclose(motion.trajectory.angles(times)[0], known.robot.skeleton.rest, atol=1e-12)
    assert motion.trajectory.duration == stay(known.robot.skeleton.rest).duration


@pytest.fixture
def changes(monkeypatch, known):
    """Leads a course around whose changes leave so much [m] of what is lacking; which one is taken."""
    rest = known.robot.skeleton.rest

    def taken(*left: float) -> int | None:
        keys = tuple(KeyPosture.whole(float(k), rest) for k in range(3))
        start, *others = (PostureCourse(keys, sealed([0.0, 1.0, 2.0]), known.robot, known.limits) for _ in (0, *left))
        lacking = {id(course): amount for course, amount in zip((start, *others), (1.0, *left), strict=True)}

        class Scan:
            def __init__(self, course: PostureCourse) -> None:
                self.lacking = np.array([0.0, lacking[id(course)], 0.0])

            @classmethod
            def of(cls, course, distances, least):
                return cls(course)

            def after(self, course, distances, least):
                return Scan(course)

            def same(self, samples, before):
                return samples

        monkeypatch.setattr(detour, "_Scan", Scan)
        monkeypatch.setattr(detour, "_changes", lambda course, *_: iter(others if course is start else ()))
        found = lead_around(start, known.distances, least=0.01)
        return None if found is start else next(k for k, other in enumerate(others) if other is found)

    return taken


def test_change_that_leaves_as_good_as_all_is_none(changes):
    assert changes(1.01 * GAIN) is None
    assert changes(0.99 * GAIN) == 0


def test_later_change_is_taken_only_where_it_leaves_plainly_less(changes):
    plainly = 0.5 - PLAINLY * 0.5
    assert changes(0.5, plainly + 0.01) == 0
    assert changes(0.5, plainly - 0.01) == 1
    assert changes(0.5, 0.6, plainly - 0.01) == 2


def test_change_that_leaves_nothing_is_taken_at_once(changes):
    assert changes(0.0, -5.0) == 0
    assert changes(0.5, 0.0, -5.0) == 1
