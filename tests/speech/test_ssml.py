from xml.etree.ElementTree import fromstring

import pytest

from kinesic.body.utterance import Emphasis, Mark, Pause, Script
from kinesic.speech.ssml import ssml


def test_marks_are_called_by_their_number_among_all_stops():
    script = Script("one two", (Mark("a<b", 0), Mark("a<b", 4)), pauses=(Pause(4, 0.25),))
    assert ssml(script) == '<speak><mark name="0"/>one <break time="250ms"/><mark name="2"/>two</speak>'


def test_a_pause_stands_between_the_marks_that_it_is_between():
    script = Script("one two", (Mark("a", 4), Mark("b", 4)), pauses=(Pause(4, 0.1, after=1), Pause(4, 0.2, after=2)))
    kinds = [(element.tag, element.get("name") or element.get("time")) for element in fromstring(ssml(script))]
    assert kinds == [("mark", "0"), ("break", "100ms"), ("mark", "2"), ("break", "200ms")]


def test_text_is_escaped_and_has_no_control_characters():
    written = ssml(Script('a < b & "c"\x00\x07]]>'))
    assert fromstring(written).text == 'a < b & "c"  ]]>'


def test_emphases_enclose_what_they_concern_and_nest():
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
    assert ssml(script) == (
        '<speak><prosody rate="slow">one <mark name="0"/><emphasis level="strong">two</emphasis></prosody>'
        ' <voice xml:lang="fr">three</voice></speak>'
    )


@pytest.mark.parametrize("spans", [[(0, 5), (3, 8)], [(3, 8), (0, 5)], [(0, 99)], [(-3, 2)]])
def test_whatever_overlaps_is_well_formed(spans: list[tuple[int, int]]):
    script = Script("0123456789", emphases=tuple(Emphasis(begin, end, "emphasis") for begin, end in spans))
    assert "".join(fromstring(ssml(script)).itertext()) == "0123456789"


@pytest.mark.parametrize(
    ("text", "place", "ends"),
    [
        ("one. Two", 5, True),
        ("one.Two", 4, True),
        ("one. two", 5, False),
        ("1.5", 2, False),
        ("1. 5", 3, True),
        ("one.", 4, False),
    ],
)
def test_a_line_ends_between_a_sentence_and_an_element(text: str, place: int, ends: bool):
    written = ssml(Script(text, (Mark("m", place),)))
    assert ("\n<mark" in written) is ends
