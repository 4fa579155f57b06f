"""How blocks say what they do to one another."""

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
from kinesic.bml.composition import BlockState, required_before, waiting_blocks, waits_for_itself
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule

NAMESPACES = (
    'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:bmla="http://www.asap-project.org/bmla" '
    'xmlns:bmlt="http://hmi.ewi.utwente.nl/bmlt"'
)


def block(attributes: str = "", inside: str = "") -> Block:
    return parse(f'<bml {NAMESPACES} id="b" {attributes}>{inside}</bml>')


@pytest.mark.parametrize(
    ("written", "meant", "succession"),
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
def test_blocks_say_whom_they_follow(written: str, meant: Composition, succession: BlockOrder) -> None:
    found = block(written)
    assert (found.composition, found.succession, found.notices) == (meant, succession, ())


def test_prefixes_that_nobody_declares_are_taken_by_name() -> None:
    found = parse('<bml id="b" bmla:chunkAfter="a"/>')
    assert found.succession.chunk_after == ("a",)
    assert found.notices == ()


def test_ids_behind_a_composition_that_takes_none_are_noticed() -> None:
    found = block('composition="REPLACE(a)"')
    assert (found.composition, len(found.notices)) == (Composition.REPLACE, 1)
    assert "REPLACE(a)" in found.notices[0].text


def test_other_attributes_of_the_extension_are_noticed() -> None:
    found = block('bmla:colour="red"')
    assert [notice.type for notice in found.notices] == [NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED]


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
def test_commands_to_other_blocks(element: str, action: object) -> None:
    found = block(inside=element)
    assert [behaviour.action for behaviour in found.behaviours] == [action]
    assert found.notices == ()


def test_a_command_is_timed_and_others_refer_to_it() -> None:
    found = block(inside='<bmla:interrupt id="i" target="a" start="2"/><head id="h" lexeme="NOD" start="i:start+1"/>')
    timed = schedule(found, {}, {})
    assert timed.timed[0].times["start"] == pytest.approx(2.0)
    assert timed.timed[0].times["end"] == pytest.approx(2.0, abs=1e-4)
    assert timed.timed[1].times["start"] == pytest.approx(3.0)


def test_a_command_without_target_refuses_the_block() -> None:
    with pytest.raises(BmlError, match=r"1:\d+.*no target.*target='bml1'"):
        block(inside='<bmla:interrupt id="i"/>')


def test_strict_reading_takes_commands() -> None:
    text = f'<bml {NAMESPACES} id="b"><bmla:activate id="i" target="a"/></bml>'
    assert parse(text, strict=True).behaviours[0].action == Activate("a")


PRESENT = {"a": BlockState.IN_EXEC, "p": BlockState.PENDING, "l": BlockState.LURKING}


@pytest.mark.parametrize(
    ("written", "waits"),
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
def test_what_a_block_waits_for(written: str, waits: dict[str, str]) -> None:
    assert required_before(block(written), PRESENT) == waits


def test_only_blocks_that_wait_are_held_back() -> None:
    found = replace(block(), succession=BlockOrder(before=("a", "p"), chunk_before=("l", "gone")))
    assert waiting_blocks(found, PRESENT) == {"p": "end", "l": "relax"}


def test_waiting_in_a_circle() -> None:
    waits = {"a": {"b": "end"}, "b": {"c": "relax"}, "c": {}}
    assert not waits_for_itself(waits, "a")
    assert waits_for_itself({**waits, "c": {"a": "end"}}, "a")
    assert not waits_for_itself({**waits, "b": {"b": "end"}}, "a")


def test_states_in_which_a_block_plays() -> None:
    assert {state for state in BlockState if state.is_playing} == {BlockState.IN_EXEC, BlockState.SUBSIDING}
