"""When the wrist is fastest, against the word that a document ties the stroke to."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.perform import perform, plan
from kinesic.controller.synchrony import StrokeLag, measure_lags, median_lag, planned_lags

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SPEECH = '<speech id="s" start="1.5"><text>Well, <sync id="m"/>hello to <sync id="n"/>you</text></speech>'
OFFER = SPEECH + '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m"/>'


def planned(known, text):
    return plan(ROOT.format(text), known)


def times_of(plan, behaviour):
    return {sync.sync: sync.planned for sync in plan.syncs if sync.behaviour == behaviour}


def bell(times, *peaks):
    """(m, 3) [m] of a wrist that is fastest at these times [s], at the last of them most of all."""
    steps = sum((k + 1) * np.exp(-(((times - at) / 0.05) ** 2)) for k, at in enumerate(peaks))
    return np.outer(np.cumsum(steps), [1e-3, 0.0, 0.0])


def measured(plan, *peaks, side="r"):
    """Lags where one wrist is fastest at these block times [s] and the other stands still."""
    times = np.arange(0.0, plan.duration + 0.3, 0.01)
    still = np.zeros((len(times), 3))
    hands = {"l": still, "r": still} | {side: bell(times, *(plan.trajectory.zero + at for at in peaks))}
    return measure_lags(plan, times, hands)


@pytest.fixture(scope="module")
def offered(known):
    return planned(known, OFFER)


def test_the_lag_is_from_the_word_to_the_fastest_moment(offered):
    word = times_of(offered, "s")["m"]
    for lag in (-0.25, -0.05):
        (found,) = measured(offered, word + lag)
        assert (found.behaviour, found.sync, found.word) == ("g", "stroke", "s:m")
        assert (found.accent, found.stroke) == pytest.approx((word, word))
        assert found.lag == pytest.approx(lag, abs=0.011)


def test_only_what_lies_between_ready_and_stroke_end_counts(offered):
    times = times_of(offered, "g")
    inside = (times["ready"] + times["strokeEnd"]) / 2
    (found,) = measured(offered, inside, times["ready"] - 0.3, times["strokeEnd"] + 0.3)
    assert found.fastest == pytest.approx(inside, abs=0.011)


def test_a_hand_that_takes_no_part_does_not_count(offered):
    times = times_of(offered, "g")
    (found,) = measured(offered, (times["ready"] + times["strokeEnd"]) / 2, side="l")
    assert found.fastest == pytest.approx(times["ready"], abs=0.011)


def test_offsets_of_the_document_belong_to_the_word(known):
    later = planned(known, OFFER.replace("s:m", "s:m + 0.3"))
    (found,) = planned_lags(later)
    assert found.accent == pytest.approx(times_of(later, "s")["m"] + 0.3)
    assert found.stroke == pytest.approx(found.accent, abs=0.011)


def test_a_stroke_may_be_tied_to_its_word_by_a_constraint_and_through_another(known):
    points = "".join(f'<sync ref="{ref}"/>' for ref in ("h:stroke", "g:stroke", "s:m"))
    constraint = f"<constraint><synchronize>{points}</synchronize></constraint>"
    both = planned(
        known,
        SPEECH
        + constraint
        + '<gesture id="g" lexeme="offer" mode="RIGHT_HAND"/><head id="h" lexeme="NOD"/>'
        + '<gesture id="k" lexeme="up" mode="LEFT_HAND" stroke="h:stroke"/>',
    )
    assert {(each.behaviour, each.word) for each in planned_lags(both)} == {("g", "s:m"), ("k", "s:m")}


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
def test_what_is_tied_to_no_word_has_no_lag(known, text):
    assert planned_lags(planned(known, text)) == ()
    assert median_lag(()) is None


def test_repeated_strokes_meet_their_own_words(known):
    text = SPEECH + '<gesture id="g" lexeme="beat_double" mode="RIGHT_HAND" stroke="s:m" strokeEnd="s:m + 1.2"/>'
    twice = planned(known, text)
    times = times_of(twice, "g")
    (found,) = measured(twice, times["stroke"] - 0.1, times["stroke:2"] - 0.1)
    assert found.fastest == pytest.approx(times["stroke"] - 0.1, abs=0.011)


def test_the_twin_is_measured_and_strokes_that_it_never_did_are_left_out(known, offered):
    performed = perform(ROOT.format(OFFER), known)
    (twin,), (asked,) = performed.stroke_lags, planned_lags(offered)
    assert twin.lag == pytest.approx(asked.lag, abs=0.05)
    sooner = {side: np.roll(path, -10, axis=0) for side, path in performed.measured.hands.items()}  # by 0.1 s
    (early,) = replace(performed, measured=replace(performed.measured, hands=sooner)).stroke_lags
    assert early.lag == pytest.approx(twin.lag - 0.1, abs=0.011)
    times = np.arange(0.0, offered.trajectory.zero + asked.accent - 0.1, 0.01)
    still = np.zeros((len(times), 3))
    assert measure_lags(offered, times, {"l": still, "r": still}) == ()


def test_the_median_has_no_signs():
    lags = [StrokeLag("g", "stroke", "s:m", 1.0, 1.0, 1.0 + lag) for lag in (-0.3, 0.1, 0.2)]
    assert median_lag(lags) == pytest.approx(0.2)
