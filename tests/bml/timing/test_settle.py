"""One behaviour between given times."""

import pytest

from kinesic.bml.block import GAZE_SYNCS, GESTURE_SYNCS
from kinesic.bml.timing.settle import fit_behaviour

SPANS = {"ready": 0.6, "strokeStart": 0.0, "stroke": 0.2, "strokeEnd": 0.2, "relax": 0.3, "end": 0.7}


def times(**given: float) -> dict[str, float]:
    return dict(zip(GESTURE_SYNCS, fit_behaviour(GESTURE_SYNCS, SPANS, given), strict=True))


def test_nothing_given_starts_at_zero_with_natural_phases() -> None:
    assert times() == pytest.approx(
        {"start": 0, "ready": 0.6, "strokeStart": 0.6, "stroke": 0.8, "strokeEnd": 1.0, "relax": 1.3, "end": 2.0}
    )


def test_a_stroke_pulls_the_rest_along() -> None:
    assert times(stroke=5.0)["start"] == pytest.approx(4.2)
    assert times(stroke=5.0)["end"] == pytest.approx(6.2)


def test_longer_than_natural_goes_into_the_hold_after_the_stroke() -> None:
    found = times(start=0.0, end=6.0)
    assert (found["strokeEnd"], found["relax"], found["end"]) == pytest.approx((1.0, 5.3, 6.0))


def test_shorter_takes_the_holds_first_and_then_all_alike() -> None:
    found = times(start=0.0, end=1.8)
    assert found["relax"] - found["strokeEnd"] == pytest.approx(0.1)
    assert found["ready"] == pytest.approx(0.6)
    found = times(start=0.0, end=0.85)
    assert found["relax"] == found["strokeEnd"]
    assert [found["ready"], found["stroke"] - found["strokeStart"]] == pytest.approx([0.3, 0.1])


def test_a_hold_before_the_stroke_and_a_preparation_give_where_nothing_else_can() -> None:
    found = times(start=0.0, strokeStart=2.0)
    assert found["ready"] == pytest.approx(0.6)
    assert times(start=0.0, ready=2.0)["strokeStart"] == pytest.approx(2.0)
    assert times(strokeStart=1.0, strokeEnd=3.0)["stroke"] in (pytest.approx(1.2), pytest.approx(2.8))


def test_no_time_at_all() -> None:
    assert set(times(start=1.0, end=1.0).values()) == {1.0}
    assert fit_behaviour(GAZE_SYNCS, {}, {"start": 0.0, "end": 2.0}) == [0.0, 0.0, 2.0, 2.0]


def test_strokes_that_are_done_once_more_give_way_before_the_first() -> None:
    names = ("start", "stroke", "stroke:2", "stroke:3", "strokeEnd", "relax", "end")
    spans = {"stroke": 0.4, "stroke:2": 0.5, "stroke:3": 0.5, "strokeEnd": 0.2, "relax": 0.3, "end": 0.4}

    def found(end: float) -> dict[str, float]:
        given = {"start": 0.0, "end": end}
        return dict(zip(names, fit_behaviour(names, spans, given, {"stroke:2", "stroke:3"}), strict=True))

    assert found(2.0) == pytest.approx(dict(zip(names, (0, 0.4, 0.9, 1.4, 1.6, 1.6, 2.0), strict=True)))
    assert found(1.5) == pytest.approx(dict(zip(names, (0, 0.4, 0.65, 0.9, 1.1, 1.1, 1.5), strict=True)))
    assert found(1.0) == pytest.approx(dict(zip(names, (0, 0.4, 0.4, 0.4, 0.6, 0.6, 1.0), strict=True)))
    assert found(0.5)["stroke"] == pytest.approx(0.2)
