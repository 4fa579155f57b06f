"""Properties of a message that are known before planning."""

import re
from dataclasses import replace

import pytest

from kinesic.bml.block import DEFAULT_BLOCK_ID, BlockOrder, BmlError, Composition
from kinesic.bml.composition import BlockState
from kinesic.bml.parse import parse
from kinesic.bml.timing.constraints import Point
from kinesic.planning.setup import Setup
from kinesic.realizer.request import (
    PLANNING_TIME,
    Message,
    SceneContext,
    anchor_references,
    block_id,
    read_request,
    refers_elsewhere,
    refusal_feedback,
    retime_request,
)

BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b" {}>{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="{}"/>'
CONTEXT = SceneContext(
    now=10.0,
    states={"a": BlockState.IN_EXEC, "p": BlockState.PENDING},
    relaxes={"a": 12.0, "p": 20.0},
    ends={"a": 13.0, "p": 21.0},
    times={Point("a", "g", "stroke"): 11.0, Point("a", "bml", "end"): 13.0},
)


def message(inside: str = "", attributes: str = "", sender: int = 0) -> Message:
    return Message(BML.format(attributes, inside), sender, "m.xml")


def test_request_contains_the_schedule_and_the_prediction_of_its_block(known: Setup) -> None:
    found = read_request(message(NOD.format("1"), 'characterId="Anna"', sender=3), known, context=CONTEXT)
    assert found.sender == 3
    assert found.timeline.timed[0].times["start"] == 1.0
    assert found.zero == 10.0
    assert 'characterId="Anna"' in found.prediction
    assert '<bml id="b" globalStart="10.0"' in found.prediction
    assert 'id="b:h" start="1.0"' in found.prediction
    assert found.notices == ()


def test_time_zero_of_a_block_is_delayed_if_a_behaviour_starts_before_it(known: Setup) -> None:
    found = read_request(message(NOD.format("-0.5")), known, context=CONTEXT)
    assert (found.zero, found.timeline.start) == (10.5, -0.5)
    assert 'globalStart="10.0"' in found.prediction


@pytest.mark.parametrize(
    ("attributes", "zero"),
    [("", 10.0), ('composition="APPEND"', 13.0), ('bmla:chunkAfter="a"', 12.0), ('composition="REPLACE"', 10.0)],
)
def test_expected_start_of_a_block_depends_on_its_composition(known: Setup, attributes: str, zero: float) -> None:
    assert read_request(message("", attributes), known, context=CONTEXT).zero == zero


def test_speech_of_a_request_ends_after_its_synthesised_duration(known: Setup) -> None:
    found = read_request(message('<speech id="s"><text>Hello <sync id="m"/>there</text></speech>'), known)
    assert found.timeline.timed[0].times["end"] == found.utterances["s"].duration > 0.0


def test_references_to_other_blocks_become_block_times(known: Setup) -> None:
    found = read_request(message(NOD.format("a:g:stroke+0.25")), known, context=CONTEXT)
    assert found.is_anchored
    assert found.zero == 10.0 + PLANNING_TIME
    assert found.zero + found.timeline.timed[0].times["start"] == pytest.approx(11.25)


def test_constraint_references_to_other_blocks_become_block_times() -> None:
    inside = NOD.format("0") + (
        '<constraint><synchronize><sync ref="h:end"/><sync ref="a:bml:end"/></synchronize>'
        '<after ref="a:g:stroke"><sync ref="h:stroke"/></after></constraint>'
    )
    block = parse(BML.format("", inside))
    assert refers_elsewhere(block)
    own = anchor_references(block, CONTEXT, 10.0)
    assert not refers_elsewhere(own)
    offsets = [ref.offset for ref in (own.constraints[0].refs[1], own.constraints[1].earlier)]
    assert offsets == pytest.approx([3.0, 1.0])


def test_behaviour_with_a_reference_to_a_missing_block_is_dropped_with_a_notice(known: Setup) -> None:
    found = read_request(
        message(NOD.format("gone:g:stroke") + NOD.replace('"h"', '"i"').format("1")), known, context=CONTEXT
    )
    assert [drop.behaviour.id for drop in found.timeline.dropped] == ["h"]
    assert "gone:g:stroke" in found.notices[0].text


def test_bml_blocks_without_id_get_unused_ids(known: Setup) -> None:
    text = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0"/>'
    taken = replace(CONTEXT, states={"block": BlockState.IN_EXEC, "block.2": BlockState.LURKING})
    assert read_request(Message(text), known).block.id == "block"
    found = read_request(Message(text), known, context=taken)
    assert (found.block.id, len(found.notices)) == ("block.3", 1)


def test_started_speech_is_not_synthesised_again(known: Setup) -> None:
    found = read_request(message('<speech id="s"><text>Hello</text></speech>'), known)
    assert retime_request(replace(found, is_decided=True), known).utterances is found.utterances
    assert retime_request(found, known).utterances is not found.utterances


def test_refusal_of_a_document_uses_its_block_id(known: Setup) -> None:
    bad = message(NOD.format("nobody:end"))
    with pytest.raises(BmlError) as caught:
        read_request(bad, known)
    xml = refusal_feedback(bad, caught.value)
    assert re.search(r'id="b" type="PARSING_FAILURE"', xml)
    assert "nobody" in xml
    assert "m.xml:1:" in xml
    assert 'id="block"' in refusal_feedback(Message(b"\xff<nothing", 1), BmlError("no XML"))


def test_document_in_a_markdown_fence_and_fml_document_are_read(known: Setup) -> None:
    fenced = Message(f"Sure:\n```xml\n{BML.format('', NOD.format(1))}\n```", 0, "m.xml")
    assert [each.type for each in read_request(fenced, known).block.behaviours] == ["head"]
    assert block_id(fenced.text) == "b"
    fml = Message('<fml-apml><fml><emotion type="joy" start="0" end="3" importance="1"/></fml></fml-apml>', 0, "m.xml")
    assert [each.type for each in read_request(fml, known).block.behaviours] == ["faceLexeme", "gesture"]


def test_expected_start_of_a_block_ignores_references_to_missing_blocks() -> None:
    block = replace(parse(BML.format("", "")), composition=Composition.APPEND, order=BlockOrder(after=("gone",)))
    assert CONTEXT.expected_start(block) == 10.0


def test_block_id_is_found_near_the_beginning_of_malformed_documents_or_is_the_default():
    """Text with many opening tags used to take hours and blocked other clients."""
    assert block_id(b"<bml " * 200_000) == DEFAULT_BLOCK_ID
    assert block_id('\n{"behaviours": [{"id": "g"}], "id": "b1"}') == "b1"
    assert block_id(b'{"id": 7}') == block_id('{"behaviours": []}') == block_id(b'{"id": "\xff"}') == DEFAULT_BLOCK_ID
    assert block_id("<bml " * 10 + ' id="late">') == "late"
    assert block_id('<!-- <bml id="old"> --><bml id="new"/>') == "new"
    assert block_id('<a><![CDATA[<bml id="old">]]></a><bml id=\' it&apos;s &#65;&amp;"B" \'/>') == 'it\'s A&"B"'
    assert block_id('<bml id="it\'s"/>') == "it's"
    assert block_id('<!-- <bml id="old">') == block_id('<bml id=" "/>') == DEFAULT_BLOCK_ID
    assert block_id(b"<a/>" * 100_000 + b'<bml id="far">') == DEFAULT_BLOCK_ID
