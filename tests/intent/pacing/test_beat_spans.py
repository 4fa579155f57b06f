"""Tests of long beats, which need time between neighbouring strokes."""

import pytest

from kinesic.bml.parse import parse
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.behaviour_sets import Choice, builtin_sets
from kinesic.intent.pacing.beat_spans import BEAT_SPANS, select_fitting
from kinesic.planning.plan import plan_block
from kinesic.session.setup import set_up

ACCENT_FORMS = [choice.lexeme for signal in builtin_sets().sets["rhythm"].signals for choice in signal.choices]
SHORT_BEAT_DURATION = 0.75  # [s] longest time from the first to the last stroke point of a beat that fits everywhere
TEXT = (
    "The gardener watered the tomatoes and the beans, and the neighbour painted the fence, and the dog slept under "
    "the table, and the postman brought a parcel with a ribbon for the baker."
)


def choices(*lexemes: str) -> list[Choice]:
    return [Choice(lexeme, 1.0) for lexeme in lexemes]


def test_long_beats_are_selected_only_with_enough_time_before_and_after():
    forms = choices("beat", "beat_roll", "beat_double")
    assert select_fitting(forms, 5.0, 5.0) == forms
    assert select_fitting(forms, 1.7, 5.0) == choices("beat", "beat_double")
    assert select_fitting(forms, 5.0, 1.4) == choices("beat", "beat_roll")


def test_beat_without_an_alternative_is_kept_although_it_lacks_time_before_its_stroke():
    assert select_fitting(choices("beat_roll"), 0.5, 5.0) == choices("beat_roll")


@pytest.mark.parametrize("lexeme", ACCENT_FORMS)
def test_each_beat_has_a_short_stroke_or_a_listed_time_span(lexeme: str):
    setup = set_up()
    planned = plan_block(parse(f'<bml id="b"><gesture id="g" lexeme="{lexeme}" stroke="4"/></bml>'), setup)
    times = [sync.planned for sync in planned.syncs if sync.sync.startswith("stroke")]
    assert (max(times) - min(times) <= SHORT_BEAT_DURATION) is (lexeme not in BEAT_SPANS)


@pytest.mark.parametrize("seed", range(8))
def test_beats_with_a_listed_time_span_are_chosen_only_if_the_span_is_free(seed: int):
    setup = set_up()
    _, selection = plan_behaviours(TEXT, setup.lexicon, Style.load("joyful"), seed=seed)
    gestures = [behaviour for behaviour in selection.behaviours if behaviour.channel == "gesture"]
    times = [gesture.intent.stroke.seconds for gesture in gestures]
    assert len(gestures) > 2
    for k, gesture in enumerate(gestures):
        span = BEAT_SPANS.get(gesture.lexeme)
        if span is not None:
            assert k == 0 or times[k] - times[k - 1] >= span.before
            assert k == len(times) - 1 or times[k + 1] - times[k] >= span.after
