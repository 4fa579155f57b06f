"""Tests of streamed text: complete phrases, spoken once, with shown behaviours counted."""

import re
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.bml.parse import parse
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import PLAIN_STYLE
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.budget import budget_of
from kinesic.intent.pacing.progress import Progress
from kinesic.intent.part_words import MAX_PART_WORDS
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text
from kinesic.intent.talk import (
    CONTEXT_WORDS,
    LETTERS_PER_WINDOW,
    MAX_SILENCE,
    SETTLING_TIME,
    Talk,
    add_words,
    is_all_said,
    next_part,
)

BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES = Lexicon.load(), Style.load("neutral"), load_language()
STORY_TEXT = (
    "Hello, and welcome! No, I did *not* say that there were three big boxes, because the night was cold. "
    "It was apples, bread, cheese and wine. Dr. Brown paid 3.50 for it... Then he went over there and laughed."
)


def parts_of(pieces, *, ends=True, **more):
    """Return all parts of a streamed text, and its final state."""
    talk, results = Talk(), []
    for text, is_last in [(piece, False) for piece in pieces] + [("", True)] * ends:
        talk = add_words(talk, text, ends=is_last)
        while (
            part := next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets(), **more)
        ) is not None:
            talk = part.talk
            results.append(part)
    return results, talk


def words_of(parts):
    return [word for part in parts for word in part.text.split()]


@settings(deadline=None, max_examples=20)
@given(st.lists(st.integers(0, len(STORY_TEXT)), max_size=60))
def test_streamed_text_is_spoken_once_and_in_order_for_any_chunks(cuts):
    places = sorted({0, len(STORY_TEXT), *cuts})
    parts, talk = parts_of([STORY_TEXT[a:b] for a, b in pairwise(places)])
    assert words_of(parts) == [word.text for word in read_text(STORY_TEXT, ENGLISH_RULES).words]
    assert is_all_said(talk, ENGLISH_RULES)
    for part in parts:
        block = parse(part.write("b"))
        assert not block.notices
        assert part.words.stop - part.words.start <= MAX_PART_WORDS


@pytest.mark.parametrize(
    ("text", "quiet", "said"),
    [
        ("I never saw the ", 0.0, ""),
        ("I never saw the house, b", 0.0, "I never saw the house"),
        ("I never saw the house,", 0.0, ""),  # About one comma in 1,000
        ("I never saw the house,", SETTLING_TIME, "I never saw the house"),
        ("I never saw the house ", MAX_SILENCE, "I never saw the house"),
        ("We met Dr. ", SETTLING_TIME, ""),
        ("It costs 3.", 0.0, ""),
        ("Well, ", 0.0, ""),
        ("Well, ", SETTLING_TIME, "Well"),
        ("Hello! ", 0.0, "Hello"),
        ("I went to the shop and bought", 0.0, "I went to the shop"),
        ("", MAX_SILENCE, ""),
        (" ... ", MAX_SILENCE, ""),
    ],
)
def test_streamed_phrase_is_spoken_as_soon_as_it_is_complete(text, quiet, said):
    part = next_part(
        add_words(Talk(), text), BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets(), quiet=quiet
    )
    assert ("" if part is None else part.text) == said


def test_streamed_phrase_keeps_its_punctuation_and_emphasis():
    parts, _ = parts_of(["No, I did, ", '*really*, see "that" house. ', "Ha"])
    spoken = [re.search(r"<text>(.*)</text>", part.write("b"), re.DOTALL)[1] for part in parts]
    plain = [re.sub(r"<[^>]*>", "", item) for item in spoken]
    assert plain == ["No, I did,", 'really, see "that" house.', "Ha"]
    assert [part.written for part in parts] == plain
    assert '<emphasis level="strong">really</emphasis>' in spoken[1]


def test_streamed_speech_starts_after_the_previous_one_with_an_early_gesture():
    part = parts_of(["No, I did not say that! "])[0][0]
    bml = part.write("b", "a:s:end+0.20")
    assert '<speech id="s" language="en" start="a:s:end+0.20">' in bml
    assert re.search(r'<gesture [^>]*start="s:start-0.40"', bml)


def test_streamed_text_keeps_gesture_budget_and_variety():
    parts, talk = parts_of(re.findall(r"\s*\S+", STORY_TEXT * 4))
    gestures = [behaviour for part in parts for behaviour in part.behaviours if behaviour.channel == "gesture"]
    assert len(parts) > 20
    assert (
        len(gestures) == talk.progress.gestures <= budget_of(talk.progress.seconds, NEUTRAL_STYLE).gestures + 1
    )  # a run may end after its budget
    assert len(gestures) > 4
    names = [gesture.lexeme for gesture in gestures]
    pictures = [k for k, name in enumerate(names) if not name.startswith("beat")]
    assert not [names[k] for k in pictures if names[k] in names[max(0, k - 2) : k]]


def test_certain_gesture_in_streamed_text_replaces_an_uncertain_gesture_that_has_not_begun():
    first = next_part(
        add_words(Talk(), "I think that we met the captain, "),
        BUILTIN_LEXICON,
        NEUTRAL_STYLE,
        ENGLISH_RULES,
        builtin_sets(),
    )
    (near,) = [each for _, each in first.talk.shown if each.channel == "gesture"]
    accent = replace(near, intent=replace(near.intent, certainty=0.1, stroke=first.passage.stress(6)))
    talk = replace(first.talk, shown=(("g1", accent),), progress=Progress(gestures=1))
    talk = add_words(talk, "NEVER again! ")
    fixed = next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets())
    free = next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets(), free=("g1",))
    assert fixed.replaced == frozenset()
    assert "gesture" not in {behaviour.channel for behaviour in fixed.behaviours}
    assert free.replaced == {"g1"}
    assert "gesture" in {behaviour.channel for behaviour in free.behaviours}
    assert free.talk.progress.gestures == 1


def test_correction_of_streamed_text_keeps_spoken_words():
    parts, talk = parts_of(["Hello! ", "I like"], ends=False)
    talk = add_words(talk, "We like rain. ", instead=True, ends=True)
    part = next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets())
    assert [*words_of(parts), *part.text.split()] == ["Hello", "We", "like", "rain"]


def test_text_streamed_after_a_finished_text_begins_a_new_sentence():
    talk = add_words(add_words(Talk(), "I am here", ends=True), "you are there", ends=True)
    part = next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets())
    assert len(part.passage.kinds) == 2


def test_streamed_text_without_punctuation_is_spoken_in_small_parts():
    text = "and so the river went on " * 80
    parts, talk = parts_of([text])
    assert words_of(parts) == text.split()
    assert max(len(part.passage.words) for part in parts) <= max(
        CONTEXT_WORDS + MAX_PART_WORDS, LETTERS_PER_WINDOW // 4
    )
    assert is_all_said(talk, ENGLISH_RULES)


@pytest.mark.parametrize(
    "text",
    ["x" * 3 * LETTERS_PER_WINDOW + " at last", "." * 3 * LETTERS_PER_WINDOW + "at last", "," * 9 * LETTERS_PER_WINDOW],
)
def test_nonwords_and_overlong_words_do_not_block_a_streamed_text(text):
    parts, talk = parts_of([text])
    assert is_all_said(talk, ENGLISH_RULES)
    assert ("last" in words_of(parts)) is ("last" in text)


def test_next_streamed_phrase_of_a_sentence_keeps_spoken_words_as_context():
    first, second = parts_of(["I went to the shop, ", "and I came home again, "], ends=False)[0][:2]
    assert (first.words.start, second.words.start) == (0, 5)
    assert second.text == "and I came home again"
    assert second.talk.text.startswith("I went")
    assert second.talk.said == 10


def test_new_sentence_of_streamed_text_removes_spoken_sentences_from_memory():
    talk = add_words(Talk(), "I think that we *never* met the captain. ")
    first = next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets())
    assert first.talk.shown
    talk = add_words(first.talk, "He was away. ")
    second = next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets())
    assert second.talk.text.startswith("He was")
    assert second.talk.said == 3
    assert second.gap > 0.0
    assert first.gap == 0.0


def test_only_the_first_phrase_of_streamed_text_begins_a_speaking_turn():
    long = "we went on and on along the road to the sea, "
    parts = parts_of([long, long, long])[0]
    glances = [[behaviour for behaviour in part.behaviours if behaviour.intent.name == "turn-begin"] for part in parts]
    assert glances[0]
    assert not any(glances[1:])


def test_chosen_style_overrides_emotional_styles_of_words_in_streamed_text():
    text = "I am so happy that you came! :-) "
    named = parts_of([text])[0][0]
    assert any(behaviour.intent.style for behaviour in named.behaviours) == (NEUTRAL_STYLE.name == PLAIN_STYLE)
    other = next_part(
        add_words(Talk(), text),
        BUILTIN_LEXICON,
        replace(NEUTRAL_STYLE, name="other"),
        ENGLISH_RULES,
        builtin_sets(),
    )
    assert not any(behaviour.intent.style for behaviour in other.behaviours)


def test_subtitles_streamed_by_letters_and_with_silences_are_spoken_without_times():
    subtitles = "1\n00:00:01,000 --> 00:00:02,000\nHello\nthere.\n\n2\n00:00:03,000 --> 00:00:04,000\nCome in.\n\n"
    assert words_of(parts_of(subtitles)[0]) == ["Hello", "there", "Come", "in"]
    half = subtitles.index("\nthere")
    silent = parts_of([subtitles[:half], subtitles[half:]], quiet=MAX_SILENCE)[0]
    assert words_of(silent) == ["Hello", "there", "Come", "in"]


def test_words_streamed_after_a_silence_inside_an_open_bracket_are_spoken_singly():
    assert words_of(parts_of(["We saw (the", " red boats) there."], quiet=MAX_SILENCE)[0])[-3:] == [
        "red",
        "boats",
        "there",
    ]


def test_number_at_the_end_of_streamed_text_is_spoken_once_no_text_follows():
    talk = add_words(Talk(), "Forty-two is\n42")
    part = next_part(talk, BUILTIN_LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets(), quiet=MAX_SILENCE)
    assert part is not None
    assert "42" in part.text
