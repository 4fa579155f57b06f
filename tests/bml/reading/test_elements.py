"""Tests of attributes and descriptions of behaviour elements."""

import pytest

from kinesic.bml.block import Action, BmlError, Gaze, Gesture, Head, NoticeType, Pointing, Speech, SyncRef
from kinesic.bml.parse import parse

BML_1_0 = "http://www.bml-initiative.org/bml/bml-1.0"
# description with a supported behaviour; {} is its priority
BML_DESCRIPTION = '<description priority="{}" type="application/bml"><pointing target="user"/></description>'
# description of an unsupported type
UNKNOWN_DESCRIPTION = '<description priority="{}" type="RobotLights"><lights colour="red"/></description>'
# description of an unknown type with a supported behaviour
NOD_DESCRIPTION = '<description priority="{}" type="x"><head lexeme="NOD"/></description>'
# description with Greta's expressivity
GRETA_DESCRIPTION = '<description priority="{}" type="gretabml"><PWR.value>0.5</PWR.value></description>'


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
def test_attribute_values_of_the_bml_draft_are_read(xml: str, action: Action) -> None:
    block = parse(f'<bml id="b">{xml}</bml>')
    assert block.behaviours[0].action == action
    assert block.notices == ()


@pytest.mark.parametrize("attribute", ['influence="KNEES"', 'offsetDirection="POLAR"'])
def test_invalid_attribute_value_is_ignored_with_a_notice(attribute: str) -> None:
    block = parse(f'<bml id="b"><gaze id="x" target="t" {attribute}/></bml>')
    assert block.behaviours[0].action == Gaze("t")
    (notice,) = block.notices
    assert (notice.type, notice.id) == (NoticeType.PARSING_FAILURE, "b:x")
    assert "valid values" in notice.text


def test_unknown_attribute_is_reported_once_per_element_type() -> None:
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
def test_ready_time_of_a_gaze_or_face_shift_is_read_as_its_end_time(behaviour: str, syncs: dict[str, float]) -> None:
    block = parse(f'<bml xmlns="{BML_1_0}" id="b">{behaviour}</bml>')
    expected = {sync: SyncRef("b", "bml", "start", offset=time) for sync, time in syncs.items()}
    assert block.behaviours[0].syncs == expected
    assert block.notices == ()


def test_end_time_of_a_gaze_shift_overrides_its_ready_time() -> None:
    block = parse(f'<bml xmlns="{BML_1_0}" id="b"><gazeShift id="x" target="t" ready="2" end="3"/></bml>')
    assert block.behaviours[0].syncs == {"end": SyncRef("b", "bml", "start", offset=3.0)}
    assert "ready is not a sync point" in block.notices[0].text


@pytest.mark.parametrize(
    ("content", "action"),
    [
        ("", Gesture("beat")),
        (BML_DESCRIPTION.format(1), Pointing("user")),
        (UNKNOWN_DESCRIPTION.format(9), Gesture("beat")),
        (BML_DESCRIPTION.format(1) + UNKNOWN_DESCRIPTION.format(9), Pointing("user")),
        (BML_DESCRIPTION.format(1) + NOD_DESCRIPTION.format(2), Head("NOD")),
        (NOD_DESCRIPTION.format(3) + BML_DESCRIPTION.format(1), Head("NOD")),
        (BML_DESCRIPTION.format("high"), Pointing("user")),
        (GRETA_DESCRIPTION.format(2) + BML_DESCRIPTION.format(1), Gesture("beat")),
        (GRETA_DESCRIPTION.format(1) + BML_DESCRIPTION.format(2), Pointing("user")),
    ],
)
def test_supported_description_with_highest_priority_is_used(content: str, action: Action) -> None:
    (behaviour,) = parse(f'<bml id="b"><gesture id="g" lexeme="beat">{content}</gesture></bml>').behaviours
    assert (behaviour.id, behaviour.action) == ("g", action)


def test_description_element_overrides_only_the_sync_times_that_it_contains() -> None:
    described = '<description priority="1" type="x"><gaze id="z" target="user" end="4"/></description>'
    text = f'<bml id="b"><head id="h" lexeme="NOD" start="1" end="2">{described}</head></bml>'
    (behaviour,) = parse(text).behaviours
    assert (behaviour.id, behaviour.action) == ("h", Gaze("user"))
    assert behaviour.syncs == {
        "start": SyncRef("b", "bml", "start", offset=1.0),
        "end": SyncRef("b", "bml", "start", offset=4.0),
    }


def test_ssml_description_with_priority_replaces_the_text_of_a_speech() -> None:
    ssml = '<description priority="1" type="application/ssml+xml"><speak>hi <mark name="m"/>you</speak></description>'
    (behaviour,) = parse(f'<bml id="b"><speech id="s"><text>hello</text>{ssml}</speech></bml>').behaviours
    assert isinstance(behaviour.action, Speech)
    assert behaviour.action.script.text == "hi you"


@pytest.mark.parametrize(("repetition", "count"), [("1", 1), ("100", 100)])
def test_head_repetition_of_1_and_of_100_is_accepted(repetition: str, count: int) -> None:
    block = parse(f'<bml id="b"><head id="h" lexeme="NOD" repetition="{repetition}"/></bml>')
    assert block.behaviours[0].action.repetition == count


@pytest.mark.parametrize("repetition", ["0", "101", "9999", "1.5"])
def test_head_repetition_other_than_an_integer_from_1_to_100_is_refused(repetition: str) -> None:
    with pytest.raises(BmlError, match=f"repetition='{repetition}' is not an integer from 1 to 100"):
        parse(f'<bml id="b"><head id="h" lexeme="NOD" repetition="{repetition}"/></bml>')
