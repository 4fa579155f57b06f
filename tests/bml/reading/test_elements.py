"""What attributes mean: words of the draft, words that stand for nothing, and attributes that nobody reads."""

import pytest

from kinesic.bml.block import Action, Gaze, Head, NoticeType, SyncRef
from kinesic.bml.parse import parse

BML_1_0 = "http://www.bml-initiative.org/bml/bml-1.0"


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
