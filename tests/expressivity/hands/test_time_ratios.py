from dataclasses import replace

import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.durations import stroke_durations
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import Poses
from kinesic.expressivity.hands.strokes import Stroke, time_stroke
from kinesic.expressivity.hands.time_ratios import available_time_ratios
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.style.effort import Effort

A, B = (Hand(Reach(sealed([0.25, -y, 0.8]))) for y in (0.1, 0.3))
TWO_KEY_POSES = Poses({"r": (A, B)}, stroke=1)


@pytest.fixture
def timed_gesture(pace):
    """Return a gesture with its natural times multiplied by a factor."""

    def at(id: str, begin: float, share: float = 1.0) -> Stroke:
        times, now = {"start": begin}, begin
        for sync, span in stroke_durations(TWO_KEY_POSES, Effort(pace)).items():
            now += share * span
            times[sync] = now
        return Stroke(id, times, (TWO_KEY_POSES,))

    return at


def time_ratio(pace, *strokes):
    works = [time_stroke(stroke, TWO_KEY_POSES, pace) for stroke in strokes]
    ratios = available_time_ratios({"r": works}, pace)
    return [ratios[id(work)] for work in works]


def test_natural_gesture_durations_give_time_ratio_one(pace, timed_gesture):
    assert time_ratio(pace, timed_gesture("g", 1.0)) == [pytest.approx(1.0)]
    assert time_ratio(pace, timed_gesture("g", 1.0, share=2.0))[0] > 1.5


def test_gesture_at_half_its_natural_duration_has_time_ratio_one_half(pace, timed_gesture):
    assert time_ratio(pace, timed_gesture("g", 1.0, share=0.5)) == [pytest.approx(0.5, abs=0.05)]


def test_overlapping_gestures_have_less_time_than_their_natural_duration(pace, timed_gesture):
    first = timed_gesture("a", 0.0)
    far, near = (timed_gesture("b", first.times["strokeEnd"] + gap) for gap in (0.5, -0.3))
    assert time_ratio(pace, first, far) == pytest.approx([1.0, 1.0])
    crowded = time_ratio(pace, first, near)
    assert crowded[0] == crowded[1] < 1.0


def test_gesture_without_a_given_preparation_time_has_time_ratio_one(pace, timed_gesture):
    times = timed_gesture("g", 1.0).times
    open_start = replace(
        timed_gesture("g", 1.0), times={**times, "start": times["strokeStart"], "ready": times["strokeStart"]}
    )
    assert time_ratio(pace, open_start) == [pytest.approx(1.0)]


def test_gesture_faster_than_natural_has_no_overshoot_and_no_accents(pace, timed_gesture):
    def passages(stroke):
        return [key.passage for key in arrange_hands([stroke], pace).hands["r"]]

    free, hurried = passages(timed_gesture("g", 1.0)), passages(timed_gesture("g", 1.0, share=0.6))
    assert max(item.swing for item in free) > 0.5
    assert "out_power" in {item.easing for item in free}
    assert {item.swing for item in hurried} == {0.0}
    assert "out_power" not in {item.easing for item in hurried}
