from xml.etree.ElementTree import fromstring

import pytest

from kinesic.body.utterance import Emphasis, Mark, Pause, Script
from kinesic.speech.ssml import write_ssml


def test_ssml_marks_are_named_by_their_index_among_marks_and_pauses():
    script = Script("one two", (Mark("a<b", 0), Mark("a<b", 4)), pauses=(Pause(4, 0.25),))
    assert write_ssml(script) == '<speak><mark name="0"/>one <break time="250ms"/><mark name="2"/>two</speak>'


def test_ssml_pauses_and_marks_at_one_position_keep_their_order():
    script = Script("one two", (Mark("a", 4), Mark("b", 4)), pauses=(Pause(4, 0.1, after=1), Pause(4, 0.2, after=2)))
    kinds = [(element.tag, element.get("name") or element.get("time")) for element in fromstring(write_ssml(script))]
    assert kinds == [("mark", "0"), ("break", "100ms"), ("mark", "2"), ("break", "200ms")]


def test_ssml_text_is_escaped_without_control_characters():
    output = write_ssml(Script('a < b & "c"\x00\x07]]>'))
    assert fromstring(output).text == 'a < b & "c"  ]]>'


def test_ssml_emphases_enclose_their_text_and_nest():
    script = Script(
        "one two three",
        (Mark("m", 4),),
        emphases=(
            Emphasis(0, 7, "prosody", (("rate", "slow"),)),
            Emphasis(4, 7, "emphasis", (("level", "strong"),)),
            Emphasis(8, 13, "voice", (("xml:lang", "fr"),)),
            Emphasis(5, 5, "emphasis"),
        ),
    )
    assert write_ssml(script) == (
        '<speak><prosody rate="slow">one <mark name="0"/><emphasis level="strong">two</emphasis></prosody>'
        ' <voice xml:lang="fr">three</voice></speak>'
    )


@pytest.mark.parametrize("spans", [[(0, 5), (3, 8)], [(3, 8), (0, 5)], [(0, 99)], [(-3, 2)]])
def test_overlapping_emphases_give_well_formed_ssml(spans: list[tuple[int, int]]):
    script = Script("0123456789", emphases=tuple(Emphasis(begin, end, "emphasis") for begin, end in spans))
    assert "".join(fromstring(write_ssml(script)).itertext()) == "0123456789"


@pytest.mark.parametrize(
    ("text", "position", "has_break"),
    [
        ("one. Two", 5, True),
        ("one.Two", 4, True),
        ("one. two", 5, False),
        ("1.5", 2, False),
        ("1. 5", 3, True),
        ("one.", 4, False),
    ],
)
def test_ssml_mark_before_a_new_sentence_is_preceded_by_a_line_break(text: str, position: int, has_break: bool):
    output = write_ssml(Script(text, (Mark("m", position),)))
    assert ("\n<mark" in output) is has_break


@pytest.mark.parametrize(
    ("text", "boundary", "separated"),
    [
        ("now.", 3, ".\n"),
        ("apple. then", 5, ".\n then"),
        ('"here". then', 0, '".\n then'),
        ("5 %.", 0, "%.\n"),
        ("5 %... then", 0, "%...\n then"),
        ("here. then", 0, "here. then"),
        ("one! ! two", 0, "one!   two"),
        ("3.5", 1, ".5"),
        ("e.g. this", 0, "e.g. this"),
        ("and/or.", 0, "and/or.\n"),
        ("x\xb2.", 0, "x\xb2.\n"),
        ("don't.", 0, "don't."),
        ("and/or. then", 0, "and/or. then"),
        ("rains.Then so", 0, "rains. Then so"),
        ("wow!so: a:bc EU:s", 0, "wow! so: a: bc EU:s"),
    ],
)
def test_line_break_follows_a_full_stop_separated_from_its_word_by_ssml(text: str, boundary: int, separated: str):
    output = write_ssml(Script(text, (Mark("m", boundary),)))
    assert fromstring(output).find("mark") is not None
    assert "".join(fromstring(output).itertext()).endswith(separated)


def test_emoji_are_omitted_from_ssml():
    assert write_ssml(Script("Good \U0001f44d\U0001f3fd\ufe0f day")) == "<speak>Good     day</speak>"
