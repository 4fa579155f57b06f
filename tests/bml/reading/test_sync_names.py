"""Names of sync points in the spellings of other dialects."""

import pytest

from kinesic.bml.parse import parse
from kinesic.bml.reading.sync_names import SYNC_ATTRIBUTES, sync_name


@pytest.mark.parametrize(
    ("written", "meant"),
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
def test_a_name_is_one_of_ours_in_any_spelling(written: str, meant: str | None) -> None:
    assert sync_name(written) == meant


@pytest.mark.parametrize("dialect", ["", ' xmlns="http://www.bml-initiative.org/bml/bml-1.0"'])
def test_attributes_and_references_are_read_in_any_spelling(dialect: str) -> None:
    found = parse(
        f'<bml id="b"{dialect}><gesture id="g" lexeme="BEAT" stroke_start="2" stroke-end="3" relax_start="4"/>'
        '<gesture id="h" lexeme="BEAT" stroke-start="g:stroke-end+0.5" stroke_end="b:g:RELAX_START - 0.25"/>'
        '<gesture id="i" lexeme="BEAT" ready="after(g:stroke_end)" relax="stroke_end+1"/></bml>'
    )
    g, h, i = found.behaviours
    assert {sync: ref.offset for sync, ref in g.syncs.items()} == {"strokeStart": 2.0, "strokeEnd": 3.0, "relax": 4.0}
    assert [(ref.behaviour, ref.sync, ref.offset) for ref in h.syncs.values()] == [
        ("g", "strokeEnd", 0.5),
        ("g", "relax", -0.25),
    ]
    assert [(ref.behaviour, ref.sync, ref.offset) for ref in i.syncs.values()] == [("i", "strokeEnd", 1.0)]
    assert [(order.earlier.sync, order.later[0].sync) for order in found.constraints] == [("strokeEnd", "ready")]
    assert found.notices == ()


def test_a_mark_of_a_speech_keeps_its_name() -> None:
    found = parse(
        '<bml id="b"><speech id="s"><text>a <sync id="stroke_start"/>b <sync id="Relax"/>c</text></speech>'
        '<gesture id="g" lexeme="BEAT" start="s:stroke_start" stroke="s:Relax" end="s:stroke_end"/></bml>'
    )
    assert [ref.sync for ref in found.behaviours[1].syncs.values()] == ["stroke_start", "Relax", "strokeEnd"]
