"""What attributes and descriptions mean: words of the draft, words for nothing, attributes that nobody reads."""

import pytest

from kinesic.bml.block import Action, Gaze, Gesture, Head, NoticeType, Pointing, Speech, SyncRef
from kinesic.bml.parse import parse

BML_1_0 = "http://www.bml-initiative.org/bml/bml-1.0"
OURS = '<description priority="{}" type="application/bml"><pointing target="user"/></description>'
NOT_OURS = '<description priority="{}" type="RobotLights"><lights colour="red"/></description>'
NOD = '<description priority="{}" type="x"><head lexeme="NOD"/></description>'
GRETA = '<description priority="{}" type="gretabml"><PWR.value>0.5</PWR.value></description>'


@pytest.mark.parametrize(
    ("xml", "action"),
    [
        ('<head id="x" action="ROTATION" rotation="X"/>', Head("NOD")),
        ('<head id="x" rotation="y"/>', Head("SHAKE")),
        ('<gaze id="x" target="t" influence="AUTO"/>', Gaze("t")),
        ('<gaze id="x" target="t" modality="neck"/>', Gaze("t", "NECK")),
        ('<gaze id="x" offsetDirection="UP_LEFT" offsetAngle="9"/>', Gaze(offset_angle=9.0, offset_direction="UPLEFT")),
    ],
)
def test_words(xml: str, action: Action) -> None:
    block = parse(f'<bml id="b">{xml}</bml>')
    assert block.behaviours[0].action == action
    assert block.notices == ()


@pytest.mark.parametrize("attribute", ['influence="KNEES"', 'offsetDirection="POLAR"'])
def test_a_word_that_stands_for_nothing_is_passed_over_and_told(attribute: str) -> None:
    block = parse(f'<bml id="b"><gaze id="x" target="t" {attribute}/></bml>')
    assert block.behaviours[0].action == Gaze("t")
    (notice,) = block.notices
    assert (notice.type, notice.id) == (NoticeType.PARSING_FAILURE, "b:x")
    assert "known are" in notice.text


def test_an_attribute_that_nobody_reads_is_told_once_for_each_kind_of_element() -> None:
    block = parse(
        '<bml id="b"><head id="x" lexeme="NOD" speed="2"/><head id="y" speed="3"/><gaze id="z" speed="1"/></bml>'
    )
    assert [(notice.type, notice.text.split()[2:5]) for notice in block.notices] == [
        (NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, ["speed", "of", "<head>"]),
        (NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, ["speed", "of", "<gaze>"]),
    ]


@pytest.mark.parametrize(
    ("behaviour", "syncs"),
    [
        ('<gazeShift id="x" target="t" ready="2"/>', {"end": 2.0}),
        ('<faceShift id="x" lexeme="SMILE" start="1" attackPeak="2"/>', {"start": 1.0, "end": 2.0}),
        ('<gaze id="x" target="t" ready="2"/>', {"ready": 2.0}),
    ],
)
def test_what_stays_has_come_at_its_end(behaviour: str, syncs: dict[str, float]) -> None:
    block = parse(f'<bml xmlns="{BML_1_0}" id="b">{behaviour}</bml>')
    wanted = {sync: SyncRef("b", "bml", "start", offset=time) for sync, time in syncs.items()}
    assert block.behaviours[0].syncs == wanted
    assert block.notices == ()


def test_both_are_not_one() -> None:
    block = parse(f'<bml xmlns="{BML_1_0}" id="b"><gazeShift id="x" target="t" ready="2" end="3"/></bml>')
    assert block.behaviours[0].syncs == {"end": SyncRef("b", "bml", "start", offset=3.0)}
    assert "ready is no sync point" in block.notices[0].text


@pytest.mark.parametrize(
    ("inside", "action"),
    [
        ("", Gesture("beat")),
        (OURS.format(1), Pointing("user")),
        (NOT_OURS.format(9), Gesture("beat")),
        (OURS.format(1) + NOT_OURS.format(9), Pointing("user")),
        (OURS.format(1) + NOD.format(2), Head("NOD")),
        (NOD.format(3) + OURS.format(1), Head("NOD")),
        (OURS.format("high"), Pointing("user")),
        (GRETA.format(2) + OURS.format(1), Gesture("beat")),
        (GRETA.format(1) + OURS.format(2), Pointing("user")),
    ],
)
def test_the_highest_priority_that_is_understood_counts(inside: str, action: Action) -> None:
    (behaviour,) = parse(f'<bml id="b"><gesture id="g" lexeme="beat">{inside}</gesture></bml>').behaviours
    assert (behaviour.id, behaviour.action) == ("g", action)


def test_a_richer_form_keeps_the_times_unless_it_has_its_own() -> None:
    richer = '<description priority="1" type="x"><gaze id="z" target="user" end="4"/></description>'
    text = f'<bml id="b"><head id="h" lexeme="NOD" start="1" end="2">{richer}</head></bml>'
    (behaviour,) = parse(text).behaviours
    assert (behaviour.id, behaviour.action) == ("h", Gaze("user"))
    assert behaviour.syncs == {
        "start": SyncRef("b", "bml", "start", offset=1.0),
        "end": SyncRef("b", "bml", "start", offset=4.0),
    }


def test_a_speech_keeps_its_text_beside_its_markup() -> None:
    ssml = '<description priority="1" type="application/ssml+xml"><speak>hi <mark name="m"/>you</speak></description>'
    (behaviour,) = parse(f'<bml id="b"><speech id="s"><text>hello</text>{ssml}</speech></bml>').behaviours
    assert isinstance(behaviour.action, Speech)
    assert behaviour.action.script.text == "hi you"
