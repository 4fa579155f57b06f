"""Tests of detours and repeated conditioning of colliding motions."""

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
    COLLISION_SPAN,
    LAG_RESERVE,
    LIMIT_REDUCTION_FACTOR,
    MIN_LAG_RESERVE,
    REPAIR_MARGIN,
    find_colliding_behaviours,
    keep_clear,
    scan_clearance,
)
from kinesic.planning.detour import ACCEPT_RATIO, WITHDRAWAL_PENALTY, add_detours
from kinesic.planning.plan import plan_block
from kinesic.planning.posture_course import PostureCourse
from kinesic.planning.postures import Postures

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
# beats of the right hand, 4 s apart
THREE_BEATS = "".join(f'<gesture id="g{k}" lexeme="beat" mode="RIGHT_HAND" stroke="{1 + 4 * k}"/>' for k in range(3))
COLLIDING_PAIR = ("humanoid_root", "r_wrist")  # segments that collide


@pytest.fixture(scope="module")
def beats(known):
    return plan_block(parse(BML_TEMPLATE.format(THREE_BEATS)), known)


def test_collision_scan_covers_the_motion_from_start_to_end(beats, known):
    trajectory = beats.trajectory
    times, result = scan_clearance(trajectory, known.distances)
    assert (times[0], times[-1]) == (trajectory.start, trajectory.start + trajectory.duration)
    assert np.diff(times)[:-1] == pytest.approx(0.01)
    assert 0.0 < times[-1] - times[-2] <= 0.01 + 1e-9
    np.testing.assert_allclose(result.distances, known.distances.clearance(trajectory.angles(times)).distances)


def blamed(made, gaps: dict[float, float]) -> dict[str, str]:
    """Return the behaviours dropped for given gaps [m] at block times [s]."""
    least, zero = made.setup.robot.min_clearance, made.trajectory.zero
    close = Clearance(np.array([least + gap for gap in gaps.values()]), [COLLIDING_PAIR] * len(gaps))
    return find_colliding_behaviours(made.keyframes, made.motion, np.array([*gaps]) + zero, close, made.setup.robot)


def test_behaviour_is_dropped_only_if_its_reserve_above_the_required_clearance_is_too_small(beats):
    assert blamed(beats, {1.0: 1.01 * MIN_LAG_RESERVE}) == {}
    assert blamed(beats, {1.0: 0.99 * MIN_LAG_RESERVE}).keys() == {"g0"}


def test_collisions_close_in_time_are_treated_as_one_and_distant_ones_separately(beats):
    least = beats.setup.robot.min_clearance
    result = blamed(beats, {1.0: -0.004, 1.2: -0.007, 5.0: -0.001, 9.0: 0.1})
    assert result == {
        "g0": f"brings {COLLIDING_PAIR[0]} within {1000 * (least - 0.007):.0f} mm of {COLLIDING_PAIR[1]} at 1.20 s",
        "g1": f"brings {COLLIDING_PAIR[0]} within {1000 * (least - 0.001):.0f} mm of {COLLIDING_PAIR[1]} at 5.00 s",
    }
    assert list(blamed(beats, {1.0: -0.001, 5.0: -0.007})) == ["g1", "g0"]
    near = {3.0: -0.009, 3.0 + 0.9 * COLLISION_SPAN: -0.001, 3.0 - 0.9 * COLLISION_SPAN: -0.001}
    assert len(blamed(beats, near)) == 1


def test_collision_in_an_empty_block_drops_no_behaviour(known):
    empty = plan_block(parse(BML_TEMPLATE.format("")), known)
    assert (
        find_colliding_behaviours(
            empty.keyframes, empty.motion, np.zeros(1), Clearance(np.zeros(1), [COLLIDING_PAIR]), known.robot
        )
        == {}
    )


@pytest.fixture
def asked(known):
    """Return a raised right forearm between two rest keys."""
    angles = known.robot.skeleton.rest.copy()
    angles[known.robot.arm("r").joints[3]] -= 0.3
    keys = tuple(
        KeyPosture.whole(float(k), sealed(a))
        for k, a in enumerate((known.robot.skeleton.rest, angles, known.robot.skeleton.rest))
    )
    return Postures(keys, {}), replace(known, robot=replace(known.robot, min_clearance=0.2))


@pytest.fixture
def watched(monkeypatch):
    """Record the courses, required clearances and scales of all rounds."""
    courses, scales = [], []

    def record(course, *, min_clearance, distances, cache):
        courses.append((course, min_clearance))
        return course

    def conditioned(keys, setup, bonds=(), /, *, limit_scale=1.0, **more):
        scales.append(limit_scale)
        return certify(keys, setup, bonds, limit_scale=limit_scale)

    monkeypatch.setattr(clearance, "add_detours", record)
    return courses, scales, conditioned


@pytest.mark.parametrize("repairs", [0, 1, 2])
def test_colliding_motion_without_a_useful_detour_is_slowed(asked, watched, repairs: int):
    solved, setup = asked
    courses, scales, conditioned = watched
    postures, motion, times, result = keep_clear(solved, setup, conditioned=conditioned, repairs=repairs)
    assert scales == pytest.approx([LIMIT_REDUCTION_FACTOR**k for k in range(repairs + 1)])
    assert [course.stray is None for course, _ in courses] == [True] + [False] * repairs
    assert courses[0][1] == pytest.approx(0.2 + LAG_RESERVE)
    assert postures.postures == solved.postures
    np.testing.assert_allclose(result.distances, setup.distances.clearance(motion.trajectory.angles(times)).distances)
    if repairs == 2:
        first, second = courses[1][1], courses[2][1]
        assert first == pytest.approx(0.2 + LAG_RESERVE)
        assert second > 0.2 + LAG_RESERVE + 0.1 + REPAIR_MARGIN


def test_motion_with_an_accepted_detour_is_not_slowed(asked, watched, monkeypatch):
    solved, setup = asked
    _, scales, conditioned = watched

    def shift(course, **more):
        return replace(
            course, postures=tuple(replace(posture, time=posture.time + 0.001) for posture in course.postures)
        )

    monkeypatch.setattr(clearance, "add_detours", shift)
    postures, *_ = keep_clear(solved, setup, conditioned=conditioned, repairs=2)
    assert scales == [1.0, 1.0, 1.0]
    assert [posture.time for posture in postures.postures] == pytest.approx([0.003, 1.003, 2.003])


def test_collision_free_motion_is_conditioned_once(asked, watched, known):
    solved, _ = asked
    courses, scales, conditioned = watched
    keep_clear(solved, replace(known, robot=replace(known.robot, min_clearance=0.0)), conditioned=conditioned)
    assert (len(courses), scales) == (1, [1.0])


def test_single_posture_gives_a_motion_at_rest_in_this_posture(known):
    solved = Postures((KeyPosture.whole(0.0, known.robot.skeleton.rest),), {})
    postures, motion, times, _ = keep_clear(solved, known)
    assert postures is solved
    np.testing.assert_allclose(motion.trajectory.angles(times)[0], known.robot.skeleton.rest, atol=1e-12)
    assert motion.trajectory.duration == stay(known.robot.skeleton.rest).duration


@pytest.fixture
def changes(monkeypatch, known):
    """Return a function that chooses among detours with given remaining violations [m]."""
    rest = known.robot.skeleton.rest

    def taken(*left: float) -> int | None:
        keys = tuple(KeyPosture.whole(float(k), rest) for k in range(3))
        start, *others = (PostureCourse(keys, sealed([0.0, 1.0, 2.0]), known.robot, known.limits) for _ in (0, *left))
        lacking = {id(course): amount for course, amount in zip((start, *others), (1.0, *left), strict=True)}

        class Scan:
            def __init__(self, course: PostureCourse) -> None:
                self.deficits = np.array([0.0, lacking[id(course)], 0.0])

            @classmethod
            def of(cls, course, distances, min_clearance):
                return cls(course)

            def after(self, course, distances, min_clearance):
                return Scan(course)

            def same(self, samples, before):
                return samples

        monkeypatch.setattr(detour, "_Scan", Scan)
        monkeypatch.setattr(detour, "_propose_detours", lambda course, *_: iter(others if course is start else ()))
        found = add_detours(start, known.distances, min_clearance=0.01)
        return None if found is start else next(k for k, other in enumerate(others) if other is found)

    return taken


def test_detour_that_barely_reduces_the_collision_is_rejected(changes):
    assert changes(1.01 * ACCEPT_RATIO) is None
    assert changes(0.99 * ACCEPT_RATIO) == 0


def test_detour_with_further_withdrawal_must_improve_clearance_clearly(changes):
    plainly = 0.5 - WITHDRAWAL_PENALTY * 0.5
    assert changes(0.5, plainly + 0.01) == 0
    assert changes(0.5, plainly - 0.01) == 1
    assert changes(0.5, 0.6, plainly - 0.01) == 2


def test_first_collision_free_detour_is_accepted_without_trying_further_ones(changes):
    assert changes(0.0, -5.0) == 0
    assert changes(0.5, 0.0, -5.0) == 1
