from dataclasses import replace

import numpy as np
import pytest

from kinesic.expressivity.variation import Variation
from kinesic.planning.secondary.arm_times import find_arm_courses
from kinesic.planning.secondary.changes import Changes
from kinesic.planning.secondary.homeward import MAX_REST_OFFSET, MAX_RETURN_OFFSET, vary_returns
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
THREE_OFFERS = "".join(  # the same gesture three times, 5 s apart
    f'<gesture id="g{k}" lexeme="offer" mode="RIGHT_HAND" '
    f'start="{at}" stroke="{at + 1}" relax="{at + 1.8}" end="{at + 3}"/>'
    for k, at in enumerate((0.5, 5.5, 10.5))
)


@pytest.fixture(scope="module")
def exact():
    """Plan one gesture three times without variation."""
    return plan(BML_TEMPLATE.format(THREE_OFFERS), set_up())


@pytest.fixture(scope="module")
def courses(exact):
    return tuple(find_arm_courses(exact.keyframes, exact.motion, exact.setup.robot))


def found(exact, courses, seed=4, amount=1.0):
    return [*vary_returns(courses, exact.trajectory, Variation(amount, seed), "b", exact.setup.robot)]


def wrists(exact, trajectory, times):
    robot = exact.setup.robot
    return robot.skeleton.frames(trajectory.sample(trajectory.zero + times)[0]).origins[:, robot.arm("r").wrist]


def test_return_motion_of_each_gesture_lies_between_relax_and_end(exact, courses):
    (course,) = courses
    assert (course.side, [stroke.id for stroke in course.strokes]) == ("r", ["g0", "g1", "g2"])
    for k, gap in enumerate(course.gaps[1:]):
        leave, there = np.subtract(gap.return_span, exact.trajectory.zero)
        assert leave == pytest.approx(exact.syncs[f"g{k}:relax"].planned, abs=0.05)
        assert there == pytest.approx(exact.syncs[f"g{k}:end"].planned, abs=0.05)


def test_successive_hand_return_paths_differ_but_end_equally(exact, courses):
    laid = Changes(exact.trajectory, found(exact, courses)).added(np.ones(5))
    ways = []
    for k in range(3):
        leave, end = (exact.syncs[f"g{k}:{sync}"].planned for sync in ("relax", "end"))
        shares = leave + np.linspace(0.1, 0.8, 12) * (end - leave)
        ways.append(wrists(exact, laid, shares) - wrists(exact, exact.trajectory, shares))
    assert all(0.003 < np.linalg.norm(way, axis=1).max() < 0.15 for way in ways)
    assert all(np.linalg.norm(ways[a] - ways[b], axis=1).max() > 0.005 for a, b in ((0, 1), (1, 2), (0, 2)))
    assert all(way[:, 1].mean() < 0.002 for way in ways)  # the right hand no nearer to the middle
    np.testing.assert_array_equal(laid.controls[-3:], exact.trajectory.controls[-3:])


def test_rest_posture_of_the_hand_varies_until_the_next_stroke(exact, courses):
    laid = Changes(exact.trajectory, found(exact, courses)).added(np.ones(5))
    hanging = np.array([exact.syncs[f"g{k}:end"].planned + 0.1 for k in (0, 1)])
    away = wrists(exact, laid, hanging) - wrists(exact, exact.trajectory, hanging)
    assert all(0.001 < np.linalg.norm(item) < 0.05 for item in away)
    assert np.linalg.norm(away[0] - away[1]) > 0.002
    strokes = np.array([exact.syncs[f"g{k}:{sync}"].planned for k in range(3) for sync in ("strokeStart", "stroke")])
    np.testing.assert_allclose(wrists(exact, laid, strokes), wrists(exact, exact.trajectory, strokes), atol=1e-5)


def test_rest_posture_offset_is_omitted_if_no_time_remains_before_the_next_stroke(exact, courses):
    """An offset without time to end is no smooth motion."""
    (course,) = courses
    until = course.gaps[1].rests[-1][1]
    gaps = (course.gaps[0], replace(course.gaps[1], end=until), *course.gaps[2:])
    bumps = found(exact, [replace(course, gaps=gaps)])
    assert len(bumps) == len(found(exact, courses)) - 1
    assert all(np.isfinite(bump.fractions_at(np.array([until]))).all() for bump in bumps)


def test_return_variation_is_bounded_and_repeatable_by_seed(exact, courses):
    swells = found(exact, courses)
    assert len(swells) == 3 + 2
    assert all(np.abs(swell.away).max() <= max(*MAX_RETURN_OFFSET, *MAX_REST_OFFSET) + 1e-9 for swell in swells)
    assert [*map(repr, (s.away for s in found(exact, courses)))] == [*map(repr, (s.away for s in swells))]
    other = found(exact, courses, seed=5)
    assert all(np.abs(a.away - b.away).max() > 1e-3 for a, b in zip(swells, other, strict=True))
    assert not found(exact, courses, amount=0.0)


def test_varied_return_paths_keep_clearance(exact):
    varied = plan(BML_TEMPLATE.format(THREE_OFFERS), replace(exact.setup, variation=Variation(2.0, 4)))
    assert varied.clearance.distances.min() >= exact.setup.robot.min_clearance
