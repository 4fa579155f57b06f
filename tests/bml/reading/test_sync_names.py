"""Tests of sync point names in the spellings of all dialects."""

import pytest

from kinesic.bml.parse import parse
from kinesic.bml.reading.sync_names import SYNC_ATTRIBUTES, find_sync_name


@pytest.mark.parametrize(
    ("text", "sync"),
    [
        *((name, name) for name in SYNC_ATTRIBUTES),
        ("stroke_start", "strokeStart"),
        ("stroke-start", "strokeStart"),
        ("STROKE_END", "strokeEnd"),
        ("strokeENd", "strokeEnd"),
        ("attack-peak", "attackPeak"),
        ("relax_start", "relax"),
        ("retraction-end", "end"),
        ("tm1", None),
        ("stroke-", None),
        ("_stroke", None),
        ("stroke:2", None),
        ("strokes", None),
    ],
)
def test_sync_names_are_recognised_regardless_of_case_and_separators(text: str, sync: str | None) -> None:
    assert find_sync_name(text) == sync


@pytest.mark.parametrize("dialect", ["", ' xmlns="http://www.bml-initiative.org/bml/bml-1.0"'])
def test_sync_attributes_and_references_ignore_case_and_separators(dialect: str) -> None:
    block = parse(
        f'<bml id="b"{dialect}><gesture id="g" lexeme="BEAT" stroke_start="2" stroke-end="3" relax_start="4"/>'
        '<gesture id="h" lexeme="BEAT" stroke-start="g:stroke-end+0.5" stroke_end="b:g:RELAX_START - 0.25"/>'
        '<gesture id="i" lexeme="BEAT" ready="after(g:stroke_end)" relax="stroke_end+1"/></bml>'
    )
    g, h, i = block.behaviours
    assert {sync: ref.offset for sync, ref in g.syncs.items()} == {"strokeStart": 2.0, "strokeEnd": 3.0, "relax": 4.0}
    assert [(ref.behaviour, ref.sync, ref.offset) for ref in h.syncs.values()] == [
        ("g", "strokeEnd", 0.5),
        ("g", "relax", -0.25),
    ]
    assert [(ref.behaviour, ref.sync, ref.offset) for ref in i.syncs.values()] == [("i", "strokeEnd", 1.0)]
    assert [(order.earlier.sync, order.later[0].sync) for order in block.constraints] == [("strokeEnd", "ready")]
    assert block.notices == ()


def test_speech_mark_named_like_a_sync_point_keeps_its_spelling() -> None:
    block = parse(
        '<bml id="b"><speech id="s"><text>a <sync id="stroke_start"/>b <sync id="Relax"/>c</text></speech>'
        '<gesture id="g" lexeme="BEAT" start="s:stroke_start" stroke="s:Relax" end="s:stroke_end"/></bml>'
    )
    assert [ref.sync for ref in block.behaviours[1].syncs.values()] == ["stroke_start", "Relax", "strokeEnd"]
