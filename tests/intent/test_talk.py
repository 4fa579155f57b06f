"""A text that comes in pieces: its phrases are found whole, each word is said once, and what was shown counts."""

import re
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.bml.parse import parse
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import own_sets
from kinesic.intent.budget import budget_of
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text
from kinesic.intent.talk import (
    CONTEXT,
    LETTERS_PER_WINDOW,
    MOST_WORDS,
    SETTLED,
    SILENT,
    Talk,
    hear,
    is_all_said,
    next_part,
)

LEXICON, STYLE, LANGUAGE = Lexicon.load(), Style.load("neutral"), load_language()
STORY = (
    "Hello, and welcome! No, I did *not* say that there were three big boxes, because the night was cold. "
    "It was apples, bread, cheese and wine. Dr. Brown paid 3.50 for it... Then he went over there and laughed."
)


def parts_of(pieces, *, ends=True, **more):
    """All parts of a talk whose pieces come one after the other, as soon as they are whole; and the talk."""
    talk, found = Talk(), []
    for text, is_last in [(each, False) for each in pieces] + [("", True)] * ends:
        talk = hear(talk, text, ends=is_last)
        while (part := next_part(talk, LEXICON, STYLE, LANGUAGE, own_sets(), **more)) is not None:
            talk = part.talk
            found.append(part)
    return found, talk


def words_of(parts):
    return [word for part in parts for word in part.text.split()]


@settings(deadline=None, max_examples=20)
@given(st.lists(st.integers(0, len(STORY)), max_size=60))
def test_every_word_is_said_once_and_in_order_however_the_text_comes(cuts):
    places = sorted({0, len(STORY), *cuts})
    parts, talk = parts_of([STORY[a:b] for a, b in pairwise(places)])
    assert words_of(parts) == [word.text for word in read_text(STORY, LANGUAGE).words]
    assert is_all_said(talk, LANGUAGE)
    for part in parts:
        block = parse(part.write("b"))
        assert not block.notices
        assert part.words.stop - part.words.start <= MOST_WORDS


@pytest.mark.parametrize(
    ("text", "quiet", "said"),
    [
        ("I never saw the ", 0.0, ""),
        ("I never saw the house, b", 0.0, "I never saw the house"),
        ("I never saw the house,", 0.0, ""),  # a comma of 1,000 perhaps
        ("I never saw the house,", SETTLED, "I never saw the house"),
        ("I never saw the house ", SILENT, "I never saw the house"),
        ("We met Dr. ", SETTLED, ""),
        ("It costs 3.", 0.0, ""),
        ("Well, ", 0.0, ""),
        ("Well, ", SETTLED, "Well"),
        ("Hello! ", 0.0, "Hello"),
        ("I went to the shop and bought", 0.0, "I went to the shop"),
        ("", SILENT, ""),
        (" ... ", SILENT, ""),
    ],
)
def test_a_phrase_is_said_as_soon_as_it_is_whole_and_not_before(text, quiet, said):
    part = next_part(hear(Talk(), text), LEXICON, STYLE, LANGUAGE, own_sets(), quiet=quiet)
    assert ("" if part is None else part.text) == said


def test_what_ends_a_phrase_is_said_with_it_and_stress_goes_on_behind_it():
    parts, _ = parts_of(["No, I did, ", '*really*, see "that" house. ', "Ha"])
    spoken = [re.search(r"<text>(.*)</text>", part.write("b"), re.DOTALL)[1] for part in parts]
    plain = [re.sub(r"<[^>]*>", "", each) for each in spoken]
    assert plain == ["No, I did,", 'really, see "that" house.', "Ha"]
    assert '<emphasis level="strong">really</emphasis>' in spoken[1]


def test_a_part_begins_where_another_speech_ends_and_hurries_its_first_gesture():
    part = parts_of(["No, I did not say that! "])[0][0]
    bml = part.write("b", "a:s:end+0.20")
    assert '<speech id="s" language="en" start="a:s:end+0.20">' in bml
    assert re.search(r'<gesture [^>]*start="s:start-0.40"', bml)


def test_a_talk_in_parts_keeps_budget_and_distance_and_repeats_nothing():
    parts, talk = parts_of(re.findall(r"\s*\S+", STORY * 4))
    gestures = [each for part in parts for each in part.behaviours if each.channel == "gesture"]
    assert len(parts) > 20
    assert len(gestures) == talk.gestures <= budget_of(talk.words, STYLE).gestures
    assert len(gestures) > 4
    names = [each.lexeme for each in gestures]
    assert not [name for k, name in enumerate(names) if name in names[max(0, k - 2) : k]]


def test_a_sure_stroke_takes_the_place_of_an_unsure_one_that_has_not_begun():
    first = next_part(hear(Talk(), "I think that we met the captain, "), LEXICON, STYLE, LANGUAGE, own_sets())
    (near,) = [each for _, each in first.talk.shown if each.channel == "gesture"]
    accent = replace(near, intent=replace(near.intent, certainty=0.1, stroke=first.passage.stress(6)))
    talk = replace(first.talk, shown=(("g1", accent),), gestures=1)
    talk = hear(talk, "NEVER again! ")
    fixed = next_part(talk, LEXICON, STYLE, LANGUAGE, own_sets())
    free = next_part(talk, LEXICON, STYLE, LANGUAGE, own_sets(), free=("g1",))
    assert fixed.replaced == frozenset()
    assert "gesture" not in {each.channel for each in fixed.behaviours}
    assert free.replaced == {"g1"}
    assert "gesture" in {each.channel for each in free.behaviours}
    assert free.talk.gestures == 1


def test_words_that_take_the_place_of_others_leave_what_was_said():
    parts, talk = parts_of(["Hello! ", "I like"], ends=False)
    talk = hear(talk, "We like rain. ", instead=True, ends=True)
    part = next_part(talk, LEXICON, STYLE, LANGUAGE, own_sets())
    assert [*words_of(parts), *part.text.split()] == ["Hello", "We", "like", "rain"]


def test_a_text_behind_one_that_is_over_begins_a_sentence():
    talk = hear(hear(Talk(), "I am here", ends=True), "you are there", ends=True)
    part = next_part(talk, LEXICON, STYLE, LANGUAGE, own_sets())
    assert len(part.passage.kinds) == 2


def test_endless_sentences_and_texts_are_said_in_parts_that_stay_small():
    text = "and so the river went on " * 80
    parts, talk = parts_of([text])
    assert words_of(parts) == text.split()
    assert max(len(part.passage.words) for part in parts) <= max(CONTEXT + MOST_WORDS, LETTERS_PER_WINDOW // 4)
    assert is_all_said(talk, LANGUAGE)


@pytest.mark.parametrize(
    "text",
    ["x" * 3 * LETTERS_PER_WINDOW + " at last", "." * 3 * LETTERS_PER_WINDOW + "at last", "," * 9 * LETTERS_PER_WINDOW],
)
def test_what_is_no_word_and_what_is_too_long_for_one_holds_nothing_up(text):
    parts, talk = parts_of([text])
    assert is_all_said(talk, LANGUAGE)
    assert ("last" in words_of(parts)) is ("last" in text)
