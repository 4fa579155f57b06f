"""Blocks for several agents: each performs its own part, and the others' parts keep their times."""

import pytest

from kinesic.bml.block import Block, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

TWO = (
    '<bml id="b" {}><speech id="s"><text>one <sync id="m"/>two</text></speech>'
    '<speech id="t" agent="Amber" start="s:end"><text>three</text></speech>'
    '<head id="h" lexeme="NOD" characterId="amber" stroke="s:m"/>'
    '<gesture id="g" lexeme="beat" stroke="t:end"/><gesture id="f" lexeme="beat" start="h:stroke"/></bml>'
)


def timed(block: Block) -> Timeline:
    return schedule(block, {name: Utterance(1.0, {"m": 0.5}) for name in ("s", "t")}, {})


def own(timeline: Timeline) -> list[str]:
    return [each.behaviour.id for each in timeline.timed]


@pytest.mark.parametrize("attribute", ["agent", "characterId", "character"])
def test_the_robot_is_the_one_that_the_block_is_for(attribute: str) -> None:
    found = timed(parse(TWO.format(f'{attribute}="Bert"')))
    assert own(found) == ["s", "g", "f"]
    assert {drop.behaviour.id: drop.why for drop in found.dropped} == dict.fromkeys("th", "Amber performs it") | {
        "h": "amber performs it"
    }
    assert [n.text for n in found.notices] == [
        "speech 't' is skipped: Amber performs it",
        "head 'h' is skipped: amber performs it",
    ]


def test_what_others_perform_keeps_its_times() -> None:
    times = {each.behaviour.id: each.times for each in timed(parse(TWO.format('agent="Bert"'))).timed}
    assert times["g"]["stroke"] == pytest.approx(times["s"]["end"] + 1.0)
    assert times["f"]["start"] == pytest.approx(times["s"]["m"])


def test_the_robot_may_be_another() -> None:
    found = timed(parse(TWO.format('agent="Bert"'), performer="AMBER"))
    assert own(found) == ["t", "h"]
    assert own(timed(parse(TWO.format('agent="Bert"'), performer="Cleo"))) == []


def test_without_a_name_the_first_agent_performs_which_is_said() -> None:
    both = '<bml id="b"><head id="h" lexeme="NOD" agent="A"/><head id="i" lexeme="NOD" agent="B" start="1"/></bml>'
    block = parse(both)
    assert own(timed(block)) == ["h"]
    assert "A performs here, unless --character names another" in block.notices[0].text
    assert own(timed(parse(both, performer="B"))) == ["i"]
    assert parse('<bml id="b"><head id="h" lexeme="NOD" agent="A"/></bml>').notices == ()


def test_what_others_perform_gives_way_and_refuses_nothing() -> None:
    loop = (
        '<bml id="b" agent="A"><required><head id="h" lexeme="NOD" agent="B" start="i:end"/></required>'
        '<head id="i" lexeme="NOD" start="h:end"/></bml>'
    )
    found = timed(parse(loop))
    assert [drop.behaviour.id for drop in found.dropped] == ["h", "i"]
