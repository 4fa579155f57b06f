"""Time from a word to the highest wrist speed of its stroke."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.dry_run import dry_run
from kinesic.metrics.synchrony import StrokeLag, compute_median_lag, measure_lags, measure_planned_lags
from kinesic.session.plan import plan

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SPEECH = '<speech id="s" start="1.5"><text>Well, <sync id="m"/>hello to <sync id="n"/>you</text></speech>'
OFFER = SPEECH + '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m"/>'


def planned(known, text):
    return plan(ROOT.format(text), known)


def times_of(plan, behaviour):
    return {sync.sync: sync.planned for sync in plan.syncs if sync.behaviour == behaviour}


def bell(times, *peaks):
    """Return a wrist path (m, 3) [m] with speed peaks at given times [s].

    The last peak is the highest.
    """
    steps = sum((k + 1) * np.exp(-(((times - at) / 0.05) ** 2)) for k, at in enumerate(peaks))
    return np.outer(np.cumsum(steps), [1e-3, 0.0, 0.0])


def measured(plan, *peaks, side="r"):
    """Measure lags for one wrist with speed peaks at block times [s]."""
    times = np.arange(0.0, plan.duration + 0.3, 0.01)
    still = np.zeros((len(times), 3))
    hands = {"l": still, "r": still} | {side: bell(times, *(plan.trajectory.zero + at for at in peaks))}
    return measure_lags(plan, times, hands)


@pytest.fixture(scope="module")
def offered(known):
    return planned(known, OFFER)


def test_stroke_lag_is_the_time_from_word_to_peak_speed(offered):
    word = times_of(offered, "s")["m"]
    for lag in (-0.25, -0.05):
        (result,) = measured(offered, word + lag)
        assert (result.behaviour, result.sync, result.word) == ("g", "stroke", "s:m")
        assert (result.accent, result.stroke) == pytest.approx((word, word))
        assert result.lag == pytest.approx(lag, abs=0.011)


def test_peak_speed_is_searched_from_ready_to_stroke_end(offered):
    times = times_of(offered, "g")
    inside = (times["ready"] + times["strokeEnd"]) / 2
    (result,) = measured(offered, inside, times["ready"] - 0.3, times["strokeEnd"] + 0.3)
    assert result.fastest == pytest.approx(inside, abs=0.011)


def test_stroke_lag_of_a_one_handed_gesture_ignores_motion_of_the_other_hand(offered):
    times = times_of(offered, "g")
    (result,) = measured(offered, (times["ready"] + times["strokeEnd"]) / 2, side="l")
    assert result.fastest == pytest.approx(times["ready"], abs=0.011)


def test_offset_of_a_stroke_reference_is_added_to_the_word_time(known):
    later = planned(known, OFFER.replace("s:m", "s:m + 0.3"))
    (planned_lag,) = measure_planned_lags(later)
    assert planned_lag.accent == pytest.approx(times_of(later, "s")["m"] + 0.3)
    assert planned_lag.stroke == pytest.approx(planned_lag.accent, abs=0.011)


def test_stroke_lag_is_measured_for_strokes_tied_to_words_by_constraints(known):
    points = "".join(f'<sync ref="{ref}"/>' for ref in ("h:stroke", "g:stroke", "s:m"))
    constraint = f"<constraint><synchronize>{points}</synchronize></constraint>"
    both = planned(
        known,
        SPEECH
        + constraint
        + '<gesture id="g" lexeme="offer" mode="RIGHT_HAND"/><head id="h" lexeme="NOD"/>'
        + '<gesture id="k" lexeme="up" mode="LEFT_HAND" stroke="h:stroke"/>',
    )
    assert {(planned_lag.behaviour, planned_lag.word) for planned_lag in measure_planned_lags(both)} == {
        ("g", "s:m"),
        ("k", "s:m"),
    }


@pytest.mark.parametrize(
    "text",
    [
        '<gesture id="g" lexeme="offer" stroke="2"/>',
        SPEECH + '<gesture id="g" lexeme="offer" stroke="2"/>',
        SPEECH + '<gesture id="g" lexeme="offer" start="s:m"/>',
        SPEECH + '<gesture id="g" lexeme="offer" stroke="s:end"/>',
        SPEECH + '<head id="g" lexeme="NOD" stroke="s:m"/>',
    ],
    ids=["no speech", "a time", "not the stroke", "no word", "no hand"],
)
def test_behaviour_without_a_hand_stroke_tied_to_a_word_has_no_lag(known, text):
    assert measure_planned_lags(planned(known, text)) == ()
    assert compute_median_lag(()) is None


def test_lag_of_a_double_beat_uses_the_speed_peak_of_its_first_stroke(known):
    text = SPEECH + '<gesture id="g" lexeme="beat_double" mode="RIGHT_HAND" stroke="s:m" strokeEnd="s:m + 1.2"/>'
    twice = planned(known, text)
    times = times_of(twice, "g")
    (result,) = measured(twice, times["stroke"] - 0.1, times["stroke:2"] - 0.1)
    assert result.fastest == pytest.approx(times["stroke"] - 0.1, abs=0.011)


def test_twin_lag_follows_the_measured_hands_and_is_missing_for_a_run_stopped_before_the_word(known, offered):
    performed = dry_run(plan(ROOT.format(OFFER), known))
    (twin,), (asked,) = performed.stroke_lags, measure_planned_lags(offered)
    assert twin.lag == pytest.approx(asked.lag, abs=0.05)
    sooner = {side: np.roll(path, -10, axis=0) for side, path in performed.measured.hands.items()}  # by 0.1 s
    (early,) = replace(performed, measured=replace(performed.measured, hands=sooner)).stroke_lags
    assert early.lag == pytest.approx(twin.lag - 0.1, abs=0.011)
    times = np.arange(0.0, offered.trajectory.zero + asked.accent - 0.1, 0.01)
    still = np.zeros((len(times), 3))
    assert measure_lags(offered, times, {"l": still, "r": still}) == ()


def test_median_stroke_lag_uses_absolute_values():
    lags = [StrokeLag("g", "stroke", "s:m", 1.0, 1.0, 1.0 + lag) for lag in (-0.3, 0.1, 0.2)]
    assert compute_median_lag(lags) == pytest.approx(0.2)
