"""Tests of block order, commands to other blocks and block states."""

from dataclasses import replace

import pytest

from kinesic.bml.block import (
    Activate,
    Block,
    BlockOrder,
    BmlError,
    Composition,
    Interrupt,
    NoticeType,
    ParameterChange,
)
from kinesic.bml.composition import BlockState, find_prerequisites, find_waiting_blocks, is_waiting_for_itself
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule

XML_NAMESPACES = (
    'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:bmla="http://www.asap-project.org/bmla" '
    'xmlns:bmlt="http://hmi.ewi.utwente.nl/bmlt"'
)


def parse_block(attributes: str = "", content: str = "") -> Block:
    return parse(f'<bml {XML_NAMESPACES} id="b" {attributes}>{content}</bml>')


@pytest.mark.parametrize(
    ("text", "composition", "order"),
    [
        ("", Composition.MERGE, BlockOrder()),
        ('composition="Replace"', Composition.REPLACE, BlockOrder()),
        ('composition=" append "', Composition.APPEND, BlockOrder()),
        ('composition="APPEND-AFTER(a, c)"', Composition.APPEND, BlockOrder(after=("a", "c"))),
        ('composition="append-after (a)"', Composition.APPEND, BlockOrder(after=("a",))),
        ('composition="chunk-after(a)"', Composition.APPEND, BlockOrder(chunk_after=("a",))),
        ('bmla:appendAfter="a,c"', Composition.MERGE, BlockOrder(after=("a", "c"))),
        ('bmla:chunkAfter="a c"', Composition.MERGE, BlockOrder(chunk_after=("a", "c"))),
        ('bmla:chunkBefore="a"', Composition.MERGE, BlockOrder(chunk_before=("a",))),
        ('bmla:prependBefore="a"', Composition.MERGE, BlockOrder(before=("a",))),
        ('bmla:preplan="true"', Composition.MERGE, BlockOrder(preplanned=True)),
        ('bmlt:preplan="false"', Composition.MERGE, BlockOrder()),
        ('bmlt:interrupt="a" bmlt:onStart="c"', Composition.MERGE, BlockOrder(interrupts=("a",), activates=("c",))),
        ('bmlt:allowexternalrefs="true"', Composition.MERGE, BlockOrder()),
    ],
)
def test_composition_and_block_order_are_read(text: str, composition: Composition, order: BlockOrder) -> None:
    parsed = parse_block(text)
    assert (parsed.composition, parsed.order, parsed.notices) == (composition, order, ())


def test_undeclared_bmla_prefix_is_accepted() -> None:
    parsed = parse('<bml id="b" bmla:chunkAfter="a"/>')
    assert parsed.order.chunk_after == ("a",)
    assert parsed.notices == ()


def test_block_ids_in_a_replace_composition_give_a_notice() -> None:
    parsed = parse_block('composition="REPLACE(a)"')
    assert (parsed.composition, len(parsed.notices)) == (Composition.REPLACE, 1)
    assert "REPLACE(a)" in parsed.notices[0].text


def test_unknown_bmla_attributes_give_a_notice() -> None:
    parsed = parse_block('bmla:colour="red"')
    assert [notice.type for notice in parsed.notices] == [NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED]


@pytest.mark.parametrize(
    ("element", "action"),
    [
        ('<bmla:interrupt id="i" target="a" start="2"/>', Interrupt("a")),
        ('<bmlt:interrupt id="i" target="a" include="g, h" exclude="k"/>', Interrupt("a", ("g", "h"), ("k",))),
        ('<bmla:activate id="i" target="a"/>', Activate("a")),
        (
            '<bmla:parameterValueChange id="i" target="a:h" paramId="amount">'
            '<bmla:trajectory type="linear" initialValue="0" targetValue="0.7"/></bmla:parameterValueChange>',
            ParameterChange("a:h", "amount", "0.7"),
        ),
        (
            '<bmlt:parametervaluechange id="i" target="a" paramId="style" value="calm"/>',
            ParameterChange("a", "style", "calm"),
        ),
    ],
)
def test_interrupt_activate_and_parameter_change_commands_are_read(element: str, action: object) -> None:
    parsed = parse_block(content=element)
    assert [behaviour.action for behaviour in parsed.behaviours] == [action]
    assert parsed.notices == ()


def test_interrupt_command_is_scheduled_and_can_be_referenced() -> None:
    parsed = parse_block(
        content='<bmla:interrupt id="i" target="a" start="2"/><head id="h" lexeme="NOD" start="i:start+1"/>'
    )
    timed = schedule(parsed, {}, {})
    assert timed.timed[0].times["start"] == pytest.approx(2.0)
    assert timed.timed[0].times["end"] == pytest.approx(2.0, abs=1e-4)
    assert timed.timed[1].times["start"] == pytest.approx(3.0)


def test_block_command_without_a_target_is_rejected() -> None:
    with pytest.raises(BmlError, match=r"1:\d+.*no target.*target='bml1'"):
        parse_block(content='<bmla:interrupt id="i"/>')


def test_strict_parsing_accepts_commands_to_blocks() -> None:
    text = f'<bml {XML_NAMESPACES} id="b"><bmla:activate id="i" target="a"/></bml>'
    assert parse(text, strict=True).behaviours[0].action == Activate("a")


# states of one running and two waiting blocks
BLOCK_STATES = {"a": BlockState.IN_EXEC, "p": BlockState.PENDING, "l": BlockState.LURKING}


@pytest.mark.parametrize(
    ("text", "waits"),
    [
        ("", {}),
        ('composition="APPEND"', {"a": "end", "l": "end"}),
        ('composition="APPEND-AFTER(p,gone)"', {"p": "end"}),
        ('bmla:chunkAfter="a"', {"a": "relax"}),
        ('composition="APPEND" bmla:chunkAfter="l"', {"l": "relax"}),
        ('bmla:appendAfter="a" bmla:chunkAfter="a"', {"a": "end"}),
        ('composition="APPEND-AFTER(b)"', {}),
        ('composition="REPLACE"', {}),
    ],
)
def test_prerequisites_of_a_block_follow_from_its_composition_and_order(text: str, waits: dict[str, str]) -> None:
    assert find_prerequisites(parse_block(text), BLOCK_STATES) == waits


def test_prepend_before_delays_only_blocks_that_have_not_started() -> None:
    parsed = replace(parse_block(), order=BlockOrder(before=("a", "p"), chunk_before=("l", "gone")))
    assert find_waiting_blocks(parsed, BLOCK_STATES) == {"p": "end", "l": "relax"}


def test_circular_waiting_of_blocks_is_detected() -> None:
    waits = {"a": {"b": "end"}, "b": {"c": "relax"}, "c": {}}
    assert not is_waiting_for_itself(waits, "a")
    assert is_waiting_for_itself({**waits, "c": {"a": "end"}}, "a")
    assert not is_waiting_for_itself({**waits, "b": {"b": "end"}}, "a")


def test_block_counts_as_playing_while_in_exec_or_subsiding() -> None:
    assert {state for state in BlockState if state.is_playing} == {BlockState.IN_EXEC, BlockState.SUBSIDING}
