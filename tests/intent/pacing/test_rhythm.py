"""Tests of beats: rate by style, runs, distance from other gestures and different forms."""

from collections.abc import Sequence
from itertools import pairwise

import pytest

from kinesic.bench.meaning.stories import STORY_TEXTS
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.behaviour_sets import Choice, Signal
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.pacing.candidates import Candidate
from kinesic.intent.pacing.rhythm import is_beat, place_beats
from kinesic.intent.pacing.tempo import RUN_SPACING, Tempo, tempo_of
from kinesic.intent.pacing.variety import EMPHATIC_CERTAINTY

STEADY_TEMPO = Tempo(rate=20.0, min_rate=17.0, beat_fraction=0.4, picture_spacing=1.3, beat_spacing=1.0, run_length=3)


def make_accent(at: float, weight: float = 0.1) -> Candidate:
    moment = Moment(f"{at:g}", at)
    choices = (Choice("beat", 1.0),)
    return Candidate(
        Intent("rhythm", moment, moment, moment, weight, ""), Signal("g", "gesture", choices), weight, choices
    )


def times_of(kept: Sequence[Candidate]) -> list[float]:
    return [item.intent.stroke.seconds for item in kept]


def gestures_of(story: str, style: str) -> Sequence[ChosenBehaviour]:
    selection = plan_behaviours(STORY_TEXTS[story], Lexicon.load(), Style.load(style))[1]
    return [behaviour for behaviour in selection.behaviours if behaviour.channel == "gesture"]


def test_beats_occur_in_short_series_at_the_stroke_rate_of_the_tempo() -> None:
    times = times_of(place_beats([make_accent(0.4 * k) for k in range(300)], [], STEADY_TEMPO))
    assert len(times) == pytest.approx(40, abs=2)
    gaps = [after - before for before, after in pairwise(times)]
    assert min(gaps) >= STEADY_TEMPO.beat_spacing
    in_run = [gap <= RUN_SPACING for gap in gaps]
    assert 0.4 < sum(in_run) / len(gaps) < 0.8
    assert not any(all(in_run[k : k + STEADY_TEMPO.run_length]) for k in range(len(in_run) - STEADY_TEMPO.run_length))


def test_beats_keep_the_minimum_spacing_to_other_gestures() -> None:
    others = [2.0, 7.5, 9.0]
    times = times_of(place_beats([make_accent(0.3 * k) for k in range(40)], others, STEADY_TEMPO))
    assert times
    assert min(abs(time - other) for time in times for other in others) >= STEADY_TEMPO.beat_spacing


def test_beat_moves_from_a_weak_accent_to_a_stronger_one_soon_after_it() -> None:
    accents = [make_accent(2.0), make_accent(2.4, 0.3), make_accent(2.9)]
    assert times_of(place_beats(accents, [], STEADY_TEMPO)) == [2.4]


def test_beats_are_placed_no_further_apart_than_the_longest_silence_despite_many_earlier_strokes() -> None:
    accents = [make_accent(0.5 * k) for k in range(30)]
    times = times_of(place_beats(accents, [], STEADY_TEMPO, earlier_strokes=50))
    assert times
    strokes = [0.0, *times]
    assert max(after - before for before, after in pairwise(strokes)) <= STEADY_TEMPO.longest_silence


def test_stroke_rate_depends_on_style_within_the_measured_human_range() -> None:
    rates = [tempo_of(Style.load(name)).rate for name in ("shy", "calm", "neutral", "joyful")]
    assert rates == sorted(rates)
    assert rates[0] == 8.0
    assert 18.0 <= rates[2] <= 24.0
    assert 28.0 <= rates[3] <= 34.0 / 1.07  # voices are faster than the estimate of durations


def test_beats_of_a_joyful_story_vary_and_no_gesture_recurs_within_five() -> None:
    gestures = gestures_of("bicycle", "joyful")
    beats = [gesture.lexeme for gesture in gestures if is_beat(gesture.lexeme)]
    assert 0.4 <= len(beats) / len(gestures) <= 0.62
    assert len(set(beats)) >= len(beats) - 2
    names = [gesture.form for gesture in gestures]
    assert not any(name in names[max(k - 4, 0) : k] for k, name in enumerate(names))


def test_rhythm_adds_no_gestures_to_a_short_sentence() -> None:
    for text in ("The weather is nice today.", "I bought a big red box of apples."):
        selection = plan_behaviours(text, Lexicon.load(), Style.load("neutral"))[1]
        assert sum(behaviour.channel == "gesture" for behaviour in selection.behaviours) <= 2
        assert not any(behaviour.intent.name == "rhythm" for behaviour in selection.behaviours)


def test_beat_gestures_of_the_lexicon_are_recognised_by_their_ids() -> None:
    assert {form.id for form in Lexicon.load().forms if is_beat(form.id)} == {
        form.id for form in Lexicon.load().forms if form.category == "beat"
    }


def test_joyful_style_enlarges_no_uncertain_beats_and_repeats_only_strokes_of_feelings() -> None:
    glad = plan_behaviours("Hooray, I passed the test! Welcome to our house.", Lexicon.load(), Style.load("joyful"))[
        1
    ].behaviours
    gestures = [*gestures_of("bicycle", "joyful"), *(each for each in glad if each.channel == "gesture")]
    for behaviour in gestures:
        if is_beat(behaviour.lexeme) and behaviour.intent.certainty < EMPHATIC_CERTAINTY:
            assert behaviour.manner == {"spatial": 0.0, "repetition": 0.0}
        else:
            is_felt = behaviour.intent.name.startswith("emotion")
            assert behaviour.manner == ({} if is_felt else {"repetition": 0.0})
    names = {behaviour.intent.name for behaviour in gestures}
    assert {"picture", "emotion-joyStrong", "performative-welcome"} <= names


@pytest.mark.parametrize(
    ("text", "gesture"),
    [("The waiter opened the door.", "open_door"), ("The village had a long wall.", "wall")],
)
def test_joyful_but_not_neutral_style_illustrates_words_of_matter_of_fact_sentences(text: str, gesture: str) -> None:
    shown = {
        name: {behaviour.lexeme for behaviour in plan_behaviours(text, Lexicon.load(), Style.load(name))[1].behaviours}
        for name in ("neutral", "joyful")
    }
    assert gesture in shown["joyful"]
    assert gesture not in shown["neutral"]


def test_clause_has_one_illustrating_gesture_in_neutral_style_and_several_in_joyful_style() -> None:
    text = "We walked slowly across the square into a tiny shop behind the old church of the village."
    pictures = {
        name: {
            behaviour.lexeme
            for behaviour in plan_behaviours(text, Lexicon.load(), Style.load(name))[1].behaviours
            if behaviour.channel == "gesture" and not is_beat(behaviour.lexeme)
        }
        for name in ("neutral", "joyful")
    }
    assert len(pictures["neutral"]) == 1
    assert len(pictures["joyful"]) > 1


@pytest.mark.parametrize("story", STORY_TEXTS)
def test_40_to_60_percent_of_the_gestures_in_joyful_stories_are_beats(story: str) -> None:
    gestures = gestures_of(story, "joyful")
    assert 0.4 <= sum(is_beat(each.lexeme) for each in gestures) / len(gestures) <= 0.6
