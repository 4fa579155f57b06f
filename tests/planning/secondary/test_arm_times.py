"""Tests of strokes, gaps and rests of an arm."""

from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.expressivity.keyframes import Succession
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary import arm_times
from kinesic.planning.secondary.arm_times import (
    ArmStroke,
    Gap,
    _find_gaps,
    _find_stroke_spans,
    _list_strokes,
    find_arm_courses,
)

MOTION_START = 5.0  # [s] start of the tested motions


def moving(*spans: tuple[int, int], count: int = 100) -> Trajectory:
    """Return a motion of one joint that moves in given control-point spans."""
    steps = np.zeros(count)
    for begin, end in spans:
        steps[begin:end] = 0.01
    return Trajectory(sealed(np.cumsum(steps)[:, None]), MOTION_START, MOTION_START)


def test_rest_between_two_arm_strokes_lasts_from_the_end_to_the_start_of_motion():
    motion = moving((30, 50), (70, 90))
    times = np.arange(MOTION_START, motion.end, KNOT_INTERVAL / 50)
    is_moving = np.abs(motion.sample(times)[1][:, 0]) > 1e-6
    edges = times[1:][np.diff(is_moving.astype(int)) != 0]
    middle = float(edges[1] + edges[2]) / 2
    strokes = [ArmStroke("a", edges[0] + 0.1, edges[1] - 0.1), ArmStroke("b", edges[2] + 0.1, edges[3] - 0.1)]
    before, between, after = _find_gaps(motion, [0], strokes)
    assert (before.begin, before.end, before.rests[0][0]) == (-inf, strokes[0].begin, -inf)
    assert (after.begin, after.end, after.rests[-1][1]) == (strokes[1].end, inf, inf)
    assert (between.begin, between.end) == (strokes[0].end, strokes[1].begin)
    ((rest_begin, rest_end),) = between.rests
    assert rest_begin < middle < rest_end
    rests = [before.rests[0][1], rest_begin, rest_end, after.rests[-1][0]]
    np.testing.assert_allclose(rests, edges, atol=2.1 * KNOT_INTERVAL)
    assert np.mean(np.array(rests) - edges) == pytest.approx(0.0, abs=KNOT_INTERVAL)


def test_short_standstill_of_an_arm_does_not_count_as_rest():
    motion = moving((30, 50), (51, 70))
    (_, after) = _find_gaps(motion, [0], [ArmStroke("a", MOTION_START, MOTION_START + 0.2)])
    assert len(after.rests) == 2
    assert after.rests[-1][1] == inf


@pytest.mark.parametrize(
    ("gap", "way"),
    [
        (Gap(1.0, 5.0, ()), None),
        (Gap(1.0, 5.0, ((2.0, 3.0),)), None),
        (Gap(1.0, inf, ((2.0, inf),)), (1.0, 2.0)),
        (Gap(1.0, 5.0, ((2.0, 3.0), (4.0, 4.5))), (3.0, 4.0)),
    ],
)
def test_return_motion_after_a_stroke_ends_at_the_start_of_the_last_rest(gap: Gap, way: tuple[float, float] | None):
    assert gap.return_span == way


BOTH_HANDS = frozenset({"l_hand", "r_hand"})  # names of both hands


def strokes_of(spans, *, uses=None, successions=None, side="r") -> list[ArmStroke]:
    frames = SimpleNamespace(uses=uses or dict.fromkeys(spans, BOTH_HANDS), successions=successions or {})
    return _list_strokes(side, spans, frames)


def test_arm_stroke_without_follow_through_has_no_delay():
    assert strokes_of({"a": (1.0, 1.4)}) == [ArmStroke("a", 1.0, 1.4, 0.0, 0.0)]
    assert ArmStroke("a", 1.0, 1.4) == ArmStroke("a", 1.0, 1.4, behind=0.0, loose=0.0)


def test_strokes_of_an_arm_are_those_of_behaviours_that_use_its_hand_in_time_order():
    spans = {"late": (3.0, 3.2), "other": (2.0, 2.1), "early": (1.0, 1.4), "unknown": (0.1, 0.2)}
    uses = {"late": BOTH_HANDS, "other": frozenset({"l_hand", "head"}), "early": frozenset({"r_hand"})}
    assert [stroke.id for stroke in strokes_of(spans, uses=uses)] == ["early", "late"]
    assert [stroke.id for stroke in strokes_of(spans, uses=uses, side="l")] == ["other", "late"]


@pytest.mark.parametrize(
    ("second", "joined"),
    [
        ((1.2, 1.3), ArmStroke("b", 1.0, 1.4)),
        ((1.2, 1.9), ArmStroke("b", 1.0, 1.9)),
        ((1.4, 1.9), ArmStroke("b", 1.0, 1.9)),
        ((1.4 + 1e-9, 1.9), None),
    ],
)
def test_overlapping_strokes_of_an_arm_are_joined_to_one_without_delay(second, joined):
    loose = dict.fromkeys("ab", Succession("l", behind=0.05, loose=0.08))
    first = ArmStroke("a", 1.0, 1.4, pytest.approx(0.05), 0.08)
    apart = [first, ArmStroke("b", *second, pytest.approx(0.05), 0.08)]
    found = strokes_of({"a": (1.0, 1.4), "b": second}, successions=loose)
    assert found == (apart if joined is None else [joined])
    earlier = strokes_of({"x": (0.1, 0.2), "a": (1.0, 1.4), "b": second})
    assert [(stroke.begin, stroke.end) for stroke in earlier[1:]] == [(stroke.begin, stroke.end) for stroke in found]


@pytest.mark.parametrize(("behind", "delay"), [(0.054, 0.05), (0.056, 0.06), (0.004, 0.0)])
def test_delay_of_the_following_hand_is_a_whole_number_of_knot_intervals(behind, delay):
    loose = {"a": Succession("l", behind=behind, loose=0.033)}
    (right,) = strokes_of({"a": (1.0, 1.4)}, successions=loose)
    (left,) = strokes_of({"a": (1.0, 1.4)}, successions=loose, side="l")
    assert (right.behind, left.behind) == (pytest.approx(delay), 0.0)
    assert right.loose == left.loose == 0.033


def test_strokes_of_a_behaviour_span_its_first_and_last_stroke_sync(monkeypatch):
    rows = [
        ("a", "ready", 0.0, 0.5),
        ("a", "strokeStart", 0.0, 1.0),
        ("a", "stroke", 0.0, 1.2),
        ("b", "stroke", 0.0, 1.3),
        ("a", "strokeEnd", 0.0, 1.5),
        ("a", "relax", 0.0, 2.0),
        ("c", "relax", 0.0, 2.0),
    ]
    monkeypatch.setattr(arm_times, "list_keyed_syncs", lambda frames, motion: rows)
    spans = _find_stroke_spans(None, SimpleNamespace(trajectory=SimpleNamespace(zero=10.0)))
    assert spans == {"a": (11.0, 11.5), "b": (11.3, 11.3)}


def test_only_arms_with_strokes_have_a_course_of_their_own_joints(monkeypatch):
    monkeypatch.setattr(arm_times, "list_keyed_syncs", lambda frames, motion: [("a", "stroke", 0.0, 0.4)])
    still, moves = np.zeros(100), moving((30, 50)).controls[:, 0]
    motion = SimpleNamespace(trajectory=Trajectory(np.stack([still, moves], axis=1), MOTION_START, MOTION_START))
    robot = SimpleNamespace(sides=("l", "r"), arm=lambda side: SimpleNamespace(joints=(0,) if side == "l" else (1,)))
    for used, counts in ((BOTH_HANDS, {"l": 1, "r": 1}), (frozenset({"r_hand"}), {"r": 1}), (frozenset(), {})):
        frames = SimpleNamespace(uses={"a": used}, successions={})
        courses = {course.side: course for course in find_arm_courses(frames, motion, robot)}
        assert {side: len(course.strokes) for side, course in courses.items()} == counts
        if "r" in courses:
            assert courses["r"].gaps[1].rests == ((pytest.approx(MOTION_START + 0.48), inf),)
        if "l" in courses:
            assert courses["l"].gaps[1].rests == ((MOTION_START + 0.4, inf),)


@pytest.mark.parametrize(("step", "is_still"), [(4.9e-5, True), (5e-5, False), (-4.9e-5, True), (-6e-5, False)])
def test_arm_counts_as_moving_from_0_05_mrad_per_knot(step, is_still):
    controls = np.zeros((100, 2))
    controls[31:50:2, 0] = step
    motion = Trajectory(sealed(controls), MOTION_START, MOTION_START)
    (before, _) = _find_gaps(motion, [1, 0], [ArmStroke("a", MOTION_START + 0.9, MOTION_START + 0.95)])
    assert len(before.rests) == (1 if is_still else 2)
    assert before.rests[0][1] == pytest.approx(MOTION_START + (0.9 if is_still else 0.29))
    (before, _) = _find_gaps(motion, [1], [ArmStroke("a", MOTION_START + 0.9, MOTION_START + 0.95)])
    assert [end for _, end in before.rests] == [MOTION_START + 0.9], "the other joint stands still"


@pytest.mark.parametrize(("knots", "is_rest"), [(2, False), (4, True)])
def test_standstill_of_at_least_30_ms_is_a_rest(knots, is_rest):
    motion = moving((30, 50), (50 + knots, 70))
    (_, after) = _find_gaps(motion, [0], [ArmStroke("a", MOTION_START, MOTION_START + 0.2)])
    begin, end = MOTION_START + 0.48, MOTION_START + 0.48 + 0.01 * knots
    expected = [pytest.approx((MOTION_START + 0.2, MOTION_START + 0.28))]
    expected += [pytest.approx((begin, end))] * is_rest + [(pytest.approx(MOTION_START + 0.68), inf)]
    assert list(after.rests) == expected


def test_return_to_rest_starts_at_the_end_of_a_rest_at_the_gap_start():
    assert Gap(1.0, inf, ((1.0, 1.5), (2.0, 2.5), (4.0, inf))).return_span == (1.5, 4.0)
    assert Gap(1.0, 6.0, ((1.0, 1.5), (2.0, 2.5), (4.0, 5.0))).return_span == (1.5, 4.0)


def test_arm_without_movement_rests_before_between_and_after_its_strokes():
    strokes = [
        ArmStroke("a", MOTION_START + 0.2, MOTION_START + 0.3),
        ArmStroke("b", MOTION_START + 0.5, MOTION_START + 0.6),
    ]
    rests = [gap.rests for gap in _find_gaps(moving(), [0], strokes)]
    assert rests == [
        ((-inf, MOTION_START + 0.2),),
        ((MOTION_START + 0.3, MOTION_START + 0.5),),
        ((MOTION_START + 0.6, inf),),
    ]


def test_arm_that_already_moves_at_the_motion_start_first_rests_when_it_stands_still():
    stroke = ArmStroke("a", MOTION_START + 0.7, MOTION_START + 0.75)
    (before, after) = _find_gaps(moving((0, 40), (60, 99)), [0], [stroke])
    assert list(before.rests) == [
        (-inf, pytest.approx(MOTION_START - 0.01)),
        pytest.approx((MOTION_START + 0.38, MOTION_START + 0.58)),
    ]
    assert [begin for begin, _ in after.rests] == [pytest.approx(MOTION_START + 0.97)]
    (before, _) = _find_gaps(moving((0, 99)), [0], [stroke])
    assert list(before.rests) == [(-inf, pytest.approx(MOTION_START - 0.01))]
