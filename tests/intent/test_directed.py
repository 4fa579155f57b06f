"""Tests of stage directions performed in whole and streamed texts."""

import re

import pytest

from kinesic.bml.parse import parse
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import MIN_WAVE_DELAY, author, author_text
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.directed import find_act
from kinesic.intent.reading.language import load_language
from kinesic.intent.talk import MAX_SILENCE, Part, Talk, add_words, is_all_said, next_part

LEXICON, NEUTRAL_STYLE, ENGLISH_RULES = Lexicon.load(), Style.load("neutral"), load_language()
ASKED = re.compile(r'<(\w+) id="\w+" lexeme="(\w+)"[^>]*? (?:stroke|start)="([^"]*)"[^>]*the text asks for')


def asked(bml: str) -> list[tuple[str, ...]]:
    return [item.groups() for item in ASKED.finditer(bml)]


def stream(parts: list[str], *, ends: bool = True, quiet: float = 0.0) -> tuple[list[Part], Talk]:
    talk, spoken = Talk(), list[Part]()
    for text, is_last in [*((part, False) for part in parts), *([("", True)] * ends)]:
        talk = add_words(talk, text, ends=is_last)
        while part := next_part(talk, LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets(), quiet=quiet):
            talk = part.talk
            spoken.append(part)
    return spoken, talk


def test_stage_directions_are_performed_at_the_following_words():
    bml = author("*waves* Hi there! (laughs) That is funny. [nods] Yes.", LEXICON, NEUTRAL_STYLE)
    assert asked(bml) == [
        ("faceLexeme", "laugh", "s:w3-0.10"),
        ("gesture", "greet_wave", f"s:w1+{MIN_WAVE_DELAY:.2f}"),
        ("head", "NOD", "s:w6+0.07"),
    ]
    assert len(re.findall("<gesture ", bml)) == 1  # no wave of its own for the greeting
    assert not parse(bml).notices


def test_stage_directions_after_the_last_word_or_without_words_are_performed():
    assert asked(author("I am here. (shrugs)", LEXICON, NEUTRAL_STYLE)) == [("gesture", "doubt_shrug", "s:w3+0.81")]
    silent = author("*waves*", LEXICON, NEUTRAL_STYLE)
    assert asked(silent) == [("gesture", "greet_wave", "1.00")]
    assert "<speech" not in silent
    assert not parse(silent).notices


def test_stage_direction_without_a_behaviour_is_dropped_with_a_warning():
    written = author_text("(sighs) I am here. *juggles plates*", LEXICON, NEUTRAL_STYLE)
    assert [re.findall("'(.*)'", warning) for warning in written.warnings] == [["sighs"], ["juggles plates"]]
    assert not asked(written.bml)


@pytest.mark.parametrize("size", [1, 3, 1000])
def test_streamed_stage_directions_are_performed_once(size: int):
    text = "*waves* Hello my dear friends. (laughs) That was really very funny. So it goes. \U0001f44d"
    parts, talk = stream([text[k : k + size] for k in range(0, len(text), size)])
    acts = [lexeme for part in parts for _, lexeme, _ in asked(part.write("b"))]
    assert acts == ["greet_wave", "laugh", "thumb_up"]
    assert (
        " ".join(part.text for part in parts).strip() == "Hello my dear friends That was really very funny So it goes"
    )
    assert is_all_said(talk, ENGLISH_RULES)


def test_lone_stage_direction_is_performed_when_the_stream_ends_or_pauses():
    for ends, quiet in ((True, 0.0), (False, MAX_SILENCE)):
        parts, talk = stream(["*waves*"], ends=ends, quiet=quiet)
        assert [asked(part.write("b")) for part in parts] == [[("gesture", "greet_wave", "1.00")]]
        assert not stream([""], ends=True)[0]
        assert not ends or is_all_said(talk, ENGLISH_RULES)


def test_text_after_an_unclosed_bracket_is_spoken_after_a_long_silence():
    talk = add_words(Talk(), "We met (last year")
    waiting = next_part(talk, LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets())
    spoken = next_part(talk, LEXICON, NEUTRAL_STYLE, ENGLISH_RULES, builtin_sets(), quiet=MAX_SILENCE)
    assert waiting is None
    assert spoken is not None
    assert spoken.text == "We met last year"


def test_each_streamed_phrase_has_its_own_warnings():
    parts, _ = stream(["Hello there. See https://a.b/c now. *juggles plates* Bye."])
    warnings = [warning for part in parts for warning in part.warnings]
    assert len(warnings) == 2
    assert "https://a.b/c" in warnings[0]
    assert "juggles plates" in warnings[1]


@pytest.mark.parametrize("direction", ["at the table", "two of them", "in front of the house"])
def test_stage_direction_of_a_place_or_number_gives_no_gesture(direction: str):
    assert find_act(direction, LEXICON) is None
    assert find_act("drinks coffee", LEXICON) == ("gesture", "drink")
