"""Tests of the phase durations of one behaviour between given times."""

import pytest

from kinesic.bml.block import GAZE_SYNCS, GESTURE_SYNCS
from kinesic.bml.timing.settle import fit_behaviour

# [s] natural duration of each phase, by the sync point at its end
NATURAL_SPANS = {"ready": 0.6, "strokeStart": 0.0, "stroke": 0.2, "strokeEnd": 0.2, "relax": 0.3, "end": 0.7}


def fit_times(**fixed_times: float) -> dict[str, float]:
    return dict(zip(GESTURE_SYNCS, fit_behaviour(GESTURE_SYNCS, NATURAL_SPANS, fixed_times), strict=True))


def test_behaviour_without_fixed_times_starts_at_zero_with_natural_durations() -> None:
    assert fit_times() == pytest.approx(
        {"start": 0, "ready": 0.6, "strokeStart": 0.6, "stroke": 0.8, "strokeEnd": 1.0, "relax": 1.3, "end": 2.0}
    )


def test_given_stroke_time_shifts_all_other_sync_points() -> None:
    assert fit_times(stroke=5.0)["start"] == pytest.approx(4.2)
    assert fit_times(stroke=5.0)["end"] == pytest.approx(6.2)


def test_spare_time_of_a_behaviour_extends_its_post_stroke_hold() -> None:
    times = fit_times(start=0.0, end=6.0)
    assert (times["strokeEnd"], times["relax"], times["end"]) == pytest.approx((1.0, 5.3, 6.0))


def test_too_little_time_for_a_behaviour_shortens_holds_first_and_then_all_phases_equally() -> None:
    times = fit_times(start=0.0, end=1.8)
    assert times["relax"] - times["strokeEnd"] == pytest.approx(0.1)
    assert times["ready"] == pytest.approx(0.6)
    times = fit_times(start=0.0, end=0.85)
    assert times["relax"] == times["strokeEnd"]
    assert [times["ready"], times["stroke"] - times["strokeStart"]] == pytest.approx([0.3, 0.1])


def test_spare_time_before_a_stroke_extends_the_pre_stroke_hold_or_the_preparation() -> None:
    times = fit_times(start=0.0, strokeStart=2.0)
    assert times["ready"] == pytest.approx(0.6)
    assert fit_times(start=0.0, ready=2.0)["strokeStart"] == pytest.approx(2.0)
    assert fit_times(strokeStart=1.0, strokeEnd=3.0)["stroke"] in (pytest.approx(1.2), pytest.approx(2.8))


def test_behaviour_of_zero_duration_has_all_sync_points_at_one_time() -> None:
    assert set(fit_times(start=1.0, end=1.0).values()) == {1.0}
    assert fit_behaviour(GAZE_SYNCS, {}, {"start": 0.0, "end": 2.0}) == [0.0, 0.0, 2.0, 2.0]


def test_too_short_duration_shortens_the_first_stroke_only_after_all_repetitions() -> None:
    names = ("start", "stroke", "stroke:2", "stroke:3", "strokeEnd", "relax", "end")
    spans = {"stroke": 0.4, "stroke:2": 0.5, "stroke:3": 0.5, "strokeEnd": 0.2, "relax": 0.3, "end": 0.4}

    def fit_times(end: float) -> dict[str, float]:
        fixed_times = {"start": 0.0, "end": end}
        return dict(zip(names, fit_behaviour(names, spans, fixed_times, {"stroke:2", "stroke:3"}), strict=True))

    assert fit_times(2.0) == pytest.approx(dict(zip(names, (0, 0.4, 0.9, 1.4, 1.6, 1.6, 2.0), strict=True)))
    assert fit_times(1.5) == pytest.approx(dict(zip(names, (0, 0.4, 0.65, 0.9, 1.1, 1.1, 1.5), strict=True)))
    assert fit_times(1.0) == pytest.approx(dict(zip(names, (0, 0.4, 0.4, 0.4, 0.6, 0.6, 1.0), strict=True)))
    assert fit_times(0.5)["stroke"] == pytest.approx(0.2)
