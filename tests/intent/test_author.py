import re
from dataclasses import replace

import pytest

from kinesic.bml.parse import parse
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import EARLY, GREETED, REACHED, SET_OUT, author, hurry_first_gesture, plan_behaviours
from kinesic.intent.behaviour_sets import own_sets
from kinesic.intent.budget import GAPS, MovementBudget
from kinesic.intent.choosing import ChosenBehaviour, choose_behaviours
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.stress import count_syllables, stressed_syllable
from kinesic.intent.reading.words import read_text
from kinesic.intent.writing import write_behaviours

BOXES = "No, I did not say that! There were three big boxes, and you took the small one."


@pytest.fixture(scope="module")
def lexicon():
    return Lexicon.load()


def chosen(text, lexicon, style="neutral"):
    return plan_behaviours(text, lexicon, Style.load(style))[1].behaviours


def test_a_text_becomes_bml_that_gives_a_reason_for_each_behaviour(lexicon):
    block = parse(author(BOXES, lexicon, Style.load("neutral")))
    assert block.notices == ()
    acts = [each for each in block.behaviours if each.type != "speech"]
    assert all(each.reason for each in acts)
    assert {"large", "tick_small"} & {each.action.lexeme for each in acts if each.type == "gesture"}


def test_the_same_text_has_the_same_bml(lexicon):
    assert author(BOXES, lexicon, Style.load("sad"), seed=3) == author(BOXES, lexicon, Style.load("sad"), seed=3)


def test_a_feeling_chooses_the_manner_only_where_nobody_did(lexicon):
    text = "I am so happy, this is a wonderful day for all of us! My heart jumps with joy."
    assert 'kinesic:style="joyful"' in author(text, lexicon, Style.load("neutral"))
    assert "kinesic:style" not in author(text, lexicon, Style.load("sad"))


def test_who_denies_shakes_the_head_and_does_not_nod(lexicon):
    heads = [each for each in chosen("I have never seen this old house before.", lexicon) if each.channel == "head"]
    assert "SHAKE" in {each.lexeme for each in heads}
    assert "NOD" not in {each.lexeme for each in heads}


def test_there_points_only_where_it_is_a_place(lexicon):
    for text, points in (("There were some trees.", False), ("Put the lamp over there.", True)):
        names = {each.intent.name for each in chosen(text, lexicon) if each.channel == "gesture"}
        assert ("world-place-there" in names) is points


def test_gestures_keep_the_budget_and_do_not_repeat(lexicon):
    text = " ".join([BOXES, "Hello, my friends, and welcome to the old town."] * 8)
    passage, selection = plan_behaviours(text, lexicon, Style.load("neutral"))
    hands = [each for each in selection.behaviours if each.channel == "gesture"]
    assert 5 <= 100 * len(hands) / len(passage.words) <= 10
    names = [each.lexeme for each in hands]
    assert all(len(set(names[k : k + 3])) == len(names[k : k + 3]) for k in range(len(names)))


def test_markup_and_emoticons_are_not_said(lexicon):
    bml = author("I am *so* glad :) <b>really</b> & NOT sad", lexicon, Style.load("neutral"))
    said = re.sub(r"<[^>]*>", "", bml[bml.index("<text>") : bml.index("</text>")])
    assert said.split() == ["I", "am", "so", "glad", "really", "&amp;", "not", "sad"]
    assert bml.count("<emphasis") == 2


@pytest.mark.parametrize("text", ["", "...", "?!", "\x00<<<", "a", "*", ":)", "1,000.5%", "\u6f22\u5b57", "x" * 500])
def test_any_text_becomes_a_block(lexicon, text):
    assert parse(author(text, lexicon, Style.load("neutral"))).behaviours


def test_abbreviations_end_no_sentence():
    assert len(read_text("Dr. Smith came, e.g. by train. He left.", load_language()).kinds) == 2


def test_stress_is_found_by_letters():
    words = {"banana": 1, "elephant": 0, "information": 2, "remember": 1, "yes": 0, "myself": 1}
    assert {word: stressed_syllable(word) for word in words} == words
    assert count_syllables("boxes") == 2


def test_every_gesture_of_the_sets_is_in_the_lexicon(lexicon):
    sets = own_sets().sets.values()
    names = {c.lexeme for each in sets for s in each.signals if s.channel == "gesture" for c in s.choices}
    assert names <= set(lexicon.forms_by_id)


def test_every_rule_has_a_behaviour_set():
    rules = [rule for found in load_language().rules.values() for rule in found]
    assert [rule.intent for rule in rules if own_sets().find(rule.intent) is None] == []


def meant(name: str, start: float, end: float) -> Intent:
    """An intention between two times [s], certain and strongest in the middle."""
    moments = (Moment(f"{time:g}", time) for time in (start, (start + end) / 2, end))
    return Intent(name, *moments, certainty=1.0, reason="for a test")


def test_what_has_no_room_is_left_out_with_the_reason():
    both = [meant("performative-greet", 1.0, 2.0), meant("performative-greet", 1.1, 2.1)]
    for gestures, whys in (
        (0, ["the budget of 0 gestures is spent on what is more certain"] * 2),
        (9, ["0.1 s from performative-greet, which is at least as certain, is too near for the gesture"]),
    ):
        selection = choose_behaviours(both, own_sets(), MovementBudget(gestures, GAPS, {}))
        assert [each.why for each in selection.omissions if each.channel == "gesture"] == whys
        assert sum(each.channel == "gesture" for each in selection.behaviours) == 2 - len(whys)


@pytest.mark.parametrize(
    ("channel", "lexeme", "least"),
    [("face", "joy", 0.8), ("gaze", "audience", 0.7), ("gaze", "LEFT", 0.7), ("head", "TILT", 0.8)],
)
def test_what_is_meant_for_a_moment_is_shown_long_enough_to_be_seen(channel, lexeme, least):
    """A face and a look set out a little before what is meant, and stay with it where that is longer."""
    for end, shown in ((2.1, least), (5.0, 3.1)):
        (written,) = write_behaviours([ChosenBehaviour(channel, lexeme, meant("emotion-joy", 2.0, end))])
        times = {name: float(time) for name, time in re.findall(r' (start|end)="([\d.]+)"', written)}
        assert times == {"start": 1.9, "end": pytest.approx(1.9 + shown)}


def test_the_voice_hardly_waits_for_the_first_gesture(lexicon):
    gesture = next(each for each in chosen("Hello, my dear friend!", lexicon) if each.channel == "gesture")
    assert gesture.begin == f"s:start-{SET_OUT:.2f}"
    assert gesture.intent.stroke.seconds == pytest.approx(GREETED)
    denial = next(each for each in chosen("No, I did not say it!", lexicon) if each.channel == "gesture")
    assert denial.intent.stroke.seconds >= REACHED - 0.01
    late = replace(gesture, begin="", intent=replace(gesture.intent, stroke=Moment("s:w9", EARLY + 1.0)))
    assert hurry_first_gesture(late) == late


def test_gestures_are_spread_over_a_text_where_its_end_is_as_sure_as_its_beginning(lexicon):
    denials = (
        "No, I never said that, and never did it, nor did I want it. " + "The captain walked along the river. " * 2
    )
    gestures = [each for each in chosen(f"{denials} Look over there!", lexicon) if each.channel == "gesture"]
    assert gestures[-1].intent.name == "world-place-there"
