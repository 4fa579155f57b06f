import re
from dataclasses import replace
from itertools import pairwise

import pytest

from kinesic.bench.meaning.sentences import prose
from kinesic.bml.parse import parse
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import (
    GESTURE_LEAD_TIME,
    MIN_STROKE_DELAY,
    MIN_WAVE_DELAY,
    PREPARED_STROKE_TIME,
    author,
    hurry_first_gesture,
    merge_directed,
    plan_behaviours,
    reachable,
)
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.budget import STROKE_SPACINGS, MovementBudget
from kinesic.intent.choosing import choose_behaviours
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.stress import count_syllables, stressed_english_syllable
from kinesic.intent.reading.words import read_text
from kinesic.intent.writing import write_behaviours

BOXES_TEXT = "No, I did not say that! There were three big boxes, and you took the small one."


@pytest.fixture(scope="module")
def lexicon():
    return Lexicon.load()


def chosen(text, lexicon, style="neutral"):
    return plan_behaviours(text, lexicon, Style.load(style))[1].behaviours


def test_generated_bml_gives_a_reason_for_each_behaviour(lexicon):
    block = parse(author(BOXES_TEXT, lexicon, Style.load("neutral")))
    assert block.notices == ()
    acts = [each for each in block.behaviours if each.type != "speech"]
    assert all(each.reason for each in acts)
    assert {"no_low", "count_three"} & {each.action.lexeme for each in acts if each.type == "gesture"}


def test_same_text_style_and_seed_give_the_same_bml(lexicon):
    assert author(BOXES_TEXT, lexicon, Style.load("sad"), seed=3) == author(
        BOXES_TEXT, lexicon, Style.load("sad"), seed=3
    )


def test_emotion_of_a_text_sets_the_style_of_its_bml_only_in_neutral_style(lexicon):
    text = "I am so happy, this is a wonderful day for all of us! My heart jumps with joy."
    assert 'kinesic:style="joyful"' in author(text, lexicon, Style.load("neutral"))
    assert "kinesic:style" not in author(text, lexicon, Style.load("sad"))


def test_negation_shakes_the_head_without_nods(lexicon):
    heads = [each for each in chosen("I have never seen this old house before.", lexicon) if each.channel == "head"]
    assert "SHAKE" in {each.lexeme for each in heads}
    assert "NOD" not in {each.lexeme for each in heads}


def test_word_there_gives_a_pointing_gesture_only_if_it_means_a_place(lexicon):
    for text, points in (("There were some trees.", False), ("Put the lamp over there.", True)):
        names = {each.lexeme for each in chosen(text, lexicon) if each.channel == "gesture"}
        assert bool(names & {"that_far", "that_low"}) is points


def test_generated_gestures_stay_within_the_budget_and_do_not_repeat(lexicon):
    text = " ".join([*prose(20), BOXES_TEXT, "Hello, my friends, and welcome to the old town."])
    passage, selection = plan_behaviours(text, lexicon, Style.load("neutral"))
    hands = [each for each in selection.behaviours if each.channel == "gesture"]
    assert 5 <= 100 * len(hands) / len(passage.words) <= 12
    names = [each.lexeme for each in hands]
    assert all(before != after for before, after in pairwise(names)), "the text repeats its words"


def test_markup_and_emoticons_are_not_spoken(lexicon):
    bml = author("I am *so* glad :) <b>really</b> & NOT sad", lexicon, Style.load("neutral"))
    said = re.sub(r"<[^>]*>", "", bml[bml.index("<text>") : bml.index("</text>")])
    assert said.split() == ["I", "am", "so", "glad", "really", "&amp;", "not", "sad"]
    assert bml.count("<emphasis") == 2


@pytest.mark.parametrize("text", ["", "...", "?!", "\x00<<<", "a", "*", ":)", "1,000.5%", "\u6f22\u5b57", "x" * 500])
def test_texts_of_odd_characters_become_valid_bml_blocks(lexicon, text):
    assert parse(author(text, lexicon, Style.load("neutral"))).behaviours


def test_full_stops_of_abbreviations_do_not_end_a_sentence():
    assert len(read_text("Dr. Smith came, e.g. by train. He left.", load_language()).kinds) == 2


def test_stressed_syllable_of_an_english_word_is_found_by_spelling():
    words = {"banana": 1, "elephant": 0, "information": 2, "remember": 1, "yes": 0, "myself": 1}
    assert {word: stressed_english_syllable(word) for word in words} == words
    assert count_syllables("boxes") == 2


def test_every_gesture_of_the_behaviour_sets_is_in_the_lexicon(lexicon):
    sets = builtin_sets().sets.values()
    names = {c.lexeme for each in sets for s in each.signals if s.channel == "gesture" for c in s.choices}
    assert names <= set(lexicon.forms_by_id)


def test_every_english_rule_has_a_behaviour_set():
    rules = [rule for found in load_language().rules.values() for rule in found]
    assert [rule.intent for rule in rules if builtin_sets().find(rule.intent) is None] == []


def meant(name: str, start: float, end: float) -> Intent:
    """Return an intent between two times [s] with its stroke in the middle."""
    moments = (Moment(f"{time:g}", time) for time in (start, (start + end) / 2, end))
    return Intent(name, *moments, certainty=1.0, reason="for a test")


def test_intents_beyond_gesture_budget_or_spacing_are_omitted_with_a_reason():
    both = [meant("performative-greet", 1.0, 2.0), meant("performative-greet", 1.1, 2.1)]
    for gestures, whys in (
        (0, ["the budget of 0 gestures is spent on more certain ones"] * 2),
        (9, ["0.1 s from performative-greet, which is at least as certain, is too near for the gesture"]),
    ):
        selection = choose_behaviours(both, builtin_sets(), MovementBudget(gestures, STROKE_SPACINGS, {}))
        assert [each.why for each in selection.omissions if each.channel == "gesture"] == whys
        assert sum(each.channel == "gesture" for each in selection.behaviours) == 2 - len(whys)


@pytest.mark.parametrize(
    ("channel", "lexeme", "least"),
    [("face", "joy", 0.8), ("gaze", "audience", 0.7), ("gaze", "LEFT", 0.7), ("head", "TILT", 0.8)],
)
def test_behaviours_for_short_intents_have_a_minimum_duration(channel, lexeme, least):
    """Expect a start before the intent, and a minimum duration."""
    for end, shown in ((2.1, least), (5.0, 3.1)):
        (written,) = write_behaviours([ChosenBehaviour(channel, lexeme, meant("emotion-joy", 2.0, end))])
        times = {name: float(time) for name, time in re.findall(r' (start|end)="([\d.]+)"', written)}
        assert times == {"start": 1.9, "end": pytest.approx(1.9 + shown)}


def test_first_gesture_starts_just_before_the_first_word(lexicon):
    denial = next(each for each in chosen("No, I did not say it!", lexicon) if each.channel == "gesture")
    assert denial.begin == f"s:start-{GESTURE_LEAD_TIME:.2f}"
    assert denial.intent.stroke.seconds >= MIN_STROKE_DELAY - 0.01
    later = chosen("No, I did not say that. There were three boxes.", lexicon)
    assert not next(each for each in later if each.lexeme == "count_three").begin  # it would show the number too soon


def test_first_gesture_with_time_to_prepare_does_not_start_before_the_speech(lexicon):
    wave = next(each for each in chosen("Hello, my dear friend!", lexicon) if each.channel == "gesture")
    assert (wave.begin, wave.intent.stroke.seconds) == ("", pytest.approx(MIN_WAVE_DELAY))
    assert hurry_first_gesture(wave) == wave
    late = replace(wave, intent=replace(wave.intent, stroke=Moment("s:w9", PREPARED_STROKE_TIME - 0.3)))
    assert merge_directed([late], [])[0].begin == ""
    assert merge_directed([late], [], slowness=1.5)[0].begin  # a slow style needs more time


def test_only_the_first_of_two_early_gestures_starts_before_the_speech(lexicon):
    first, second = (
        replace(each, begin="")
        for each in chosen("No, I did not say that. There were three boxes.", lexicon)
        if each.channel == "gesture"
    )
    second = replace(second, intent=replace(second.intent, stroke=Moment("s:w4", PREPARED_STROKE_TIME - 0.5)))
    assert [bool(each.begin) for each in merge_directed((second, first), ())] == [True, False]


def test_equally_certain_gestures_are_spread_over_the_text(lexicon):
    denials = (
        "No, I never said that, and never did it, nor did I want it. " + "The captain walked along the river. " * 2
    )
    gestures = [each for each in chosen(f"{denials} Look over there!", lexicon) if each.channel == "gesture"]
    assert gestures[-1].lexeme in ("that_far", "that_low")


def test_gesture_stroke_moves_off_its_word_only_if_the_hand_needs_much_longer():
    intent = Intent("picture", Moment("s:w1", 0.0), Moment("s:w1+0.45", 0.45), Moment("s:w2", 0.9), 0.9, "big", word=0)
    assert reachable(intent).stroke == intent.stroke
    early = replace(intent, stroke=Moment("s:w1+0.20", 0.2))
    assert reachable(early).stroke.reference == "s:w1+0.55"
