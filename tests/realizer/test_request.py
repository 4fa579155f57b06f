"""What can be said of a message before its motion is planned."""

import re
from dataclasses import replace

import pytest

from kinesic.bml.block import BlockOrder, BmlError, Composition
from kinesic.bml.composition import BlockState
from kinesic.bml.parse import UNNAMED, parse
from kinesic.bml.timing.constraints import Point
from kinesic.planning.setup import Setup
from kinesic.realizer.request import (
    LEAD,
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


def test_a_block_is_timed_and_told_at_once(known: Setup) -> None:
    found = read_request(message(NOD.format("1"), 'characterId="Anna"', sender=3), known, context=CONTEXT)
    assert found.sender == 3
    assert found.timeline.timed[0].times["start"] == 1.0
    assert found.zero == 10.0
    assert 'characterId="Anna"' in found.prediction
    assert '<bml id="b" globalStart="10.0"' in found.prediction
    assert 'id="b:h" start="1.0"' in found.prediction
    assert found.notices == ()


def test_a_block_that_begins_before_its_zero_is_expected_so_much_earlier(known: Setup) -> None:
    found = read_request(message(NOD.format("-0.5")), known, context=CONTEXT)
    assert (found.zero, found.timeline.start) == (10.5, -0.5)
    assert 'globalStart="10.0"' in found.prediction


@pytest.mark.parametrize(
    ("attributes", "zero"),
    [("", 10.0), ('composition="APPEND"', 13.0), ('bmla:chunkAfter="a"', 12.0), ('composition="REPLACE"', 10.0)],
)
def test_when_it_is_expected(known: Setup, attributes: str, zero: float) -> None:
    assert read_request(message("", attributes), known, context=CONTEXT).zero == zero


def test_what_is_said_takes_its_time(known: Setup) -> None:
    found = read_request(message('<speech id="s"><text>Hello <sync id="m"/>there</text></speech>'), known)
    assert found.timeline.timed[0].times["end"] == found.utterances["s"].duration > 0.0


def test_references_to_other_blocks_become_times(known: Setup) -> None:
    found = read_request(message(NOD.format("a:g:stroke+0.25")), known, context=CONTEXT)
    assert found.is_anchored
    assert found.zero == 10.0 + LEAD
    assert found.zero + found.timeline.timed[0].times["start"] == pytest.approx(11.25)


def test_references_in_constraints_become_times() -> None:
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


def test_unknown_references_stay_and_are_warned(known: Setup) -> None:
    found = read_request(
        message(NOD.format("gone:g:stroke") + NOD.replace('"h"', '"i"').format("1")), known, context=CONTEXT
    )
    assert [drop.behaviour.id for drop in found.timeline.dropped] == ["h"]
    assert "gone:g:stroke" in found.notices[0].text


def test_blocks_without_id_get_free_ones(known: Setup) -> None:
    text = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0"/>'
    taken = replace(CONTEXT, states={"block": BlockState.IN_EXEC, "block.2": BlockState.LURKING})
    assert read_request(Message(text), known).block.id == "block"
    found = read_request(Message(text), known, context=taken)
    assert (found.block.id, len(found.notices)) == ("block.3", 1)


def test_what_is_decided_is_not_said_again(known: Setup) -> None:
    found = read_request(message('<speech id="s"><text>Hello</text></speech>'), known)
    assert retime_request(replace(found, is_decided=True), known).utterances is found.utterances
    assert retime_request(found, known).utterances is not found.utterances


def test_a_bad_document_is_refused_by_the_id_of_its_block(known: Setup) -> None:
    bad = message(NOD.format("nobody:end"))
    with pytest.raises(BmlError) as caught:
        read_request(bad, known)
    xml = refusal_feedback(bad, caught.value)
    assert re.search(r'id="b" type="PARSING_FAILURE"', xml)
    assert "nobody" in xml
    assert "m.xml:1:" in xml
    assert 'id="block"' in refusal_feedback(Message(b"\xff<nothing", 1), BmlError("no XML"))


def test_expectations_count_only_what_is_known() -> None:
    block = replace(parse(BML.format("", "")), composition=Composition.APPEND, succession=BlockOrder(after=("gone",)))
    assert CONTEXT.expected_start(block) == 10.0


def test_the_id_of_a_hostile_document_is_found_or_given_up_at_once():
    """Text that begins a tag again and again took hours, and nobody else had a turn."""
    assert block_id(b"<bml " * 200_000) == UNNAMED
    assert block_id('\n{"behaviours": [{"id": "g"}], "id": "b1"}') == "b1"
    assert block_id(b'{"id": 7}') == block_id('{"behaviours": []}') == block_id(b'{"id": "\xff"}') == UNNAMED
    assert block_id("<bml " * 10 + ' id="late">') == "late"
    assert block_id('<!-- <bml id="old"> --><bml id="new"/>') == "new"
    assert block_id('<a><![CDATA[<bml id="old">]]></a><bml id=\' it&apos;s &#65;&amp;"B" \'/>') == 'it\'s A&"B"'
    assert block_id('<bml id="it\'s"/>') == "it's"
    assert block_id('<!-- <bml id="old">') == block_id('<bml id=" "/>') == UNNAMED
    assert block_id(b"<a/>" * 100_000 + b'<bml id="far">') == UNNAMED
