from dataclasses import replace

import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.durations import stroke_spans
from kinesic.expressivity.hands.leisure import find_leisure
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import Poses
from kinesic.expressivity.hands.strokes import Stroke, do_stroke
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.style.effort import Effort

A, B = (Hand(Reach(sealed([0.25, -y, 0.8]))) for y in (0.1, 0.3))
WORK = Poses({"r": (A, B)}, stroke=1)


@pytest.fixture
def asked(pace):
    """A gesture in its natural times, from a moment on, with all of them multiplied."""

    def at(id: str, begin: float, share: float = 1.0) -> Stroke:
        times, now = {"start": begin}, begin
        for sync, span in stroke_spans(WORK, Effort(pace)).items():
            now += share * span
            times[sync] = now
        return Stroke(id, times, (WORK,))

    return at


def leisure(pace, *strokes):
    works = [do_stroke(stroke, WORK, pace) for stroke in strokes]
    found = find_leisure({"r": works}, pace)
    return [found[id(work)] for work in works]


def test_a_gesture_in_its_natural_times_has_all_its_leisure(pace, asked):
    assert leisure(pace, asked("g", 1.0)) == [pytest.approx(1.0)]
    assert leisure(pace, asked("g", 1.0, share=2.0))[0] > 1.5


def test_half_the_time_is_half_the_leisure(pace, asked):
    assert leisure(pace, asked("g", 1.0, share=0.5)) == [pytest.approx(0.5, abs=0.05)]


def test_neighbours_take_leisure_from_one_another(pace, asked):
    first = asked("a", 0.0)
    far, near = (asked("b", first.times["strokeEnd"] + gap) for gap in (0.5, -0.3))
    assert leisure(pace, first, far) == pytest.approx([1.0, 1.0])
    crowded = leisure(pace, first, near)
    assert crowded[0] == crowded[1] < 1.0


def test_a_gesture_that_nobody_timed_has_its_leisure(pace, asked):
    times = asked("g", 1.0).times
    open_start = replace(asked("g", 1.0), times={**times, "start": times["strokeStart"], "ready": times["strokeStart"]})
    assert leisure(pace, open_start) == [pytest.approx(1.0)]


def test_who_has_no_leisure_neither_swings_nor_accents(pace, asked):
    def passages(stroke):
        return [key.passage for key in arrange_hands([stroke], pace).hands["r"]]

    free, hurried = passages(asked("g", 1.0)), passages(asked("g", 1.0, share=0.6))
    assert max(each.swing for each in free) > 0.5
    assert "out_power" in {each.easing for each in free}
    assert {each.swing for each in hurried} == {0.0}
    assert "out_power" not in {each.easing for each in hurried}
