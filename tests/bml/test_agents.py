"""Tests of blocks for several agents."""

import pytest

from kinesic.bml.block import Block, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

TWO_AGENTS = (  # block with behaviours of the agent Amber and of no agent
    '<bml id="b" {}><speech id="s"><text>one <sync id="m"/>two</text></speech>'
    '<speech id="t" agent="Amber" start="s:end"><text>three</text></speech>'
    '<head id="h" lexeme="NOD" characterId="amber" stroke="s:m"/>'
    '<gesture id="g" lexeme="beat" stroke="t:end"/><gesture id="f" lexeme="beat" start="h:stroke"/></bml>'
)


def timed(block: Block) -> Timeline:
    return schedule(block, {name: Utterance(1.0, {"m": 0.5}) for name in ("s", "t")}, {})


def performed_ids(timeline: Timeline) -> list[str]:
    return [timed_behaviour.behaviour.id for timed_behaviour in timeline.timed]


@pytest.mark.parametrize("attribute", ["agent", "characterId", "character"])
def test_robot_performs_only_behaviours_of_the_agent_named_by_the_block(attribute: str) -> None:
    timeline = timed(parse(TWO_AGENTS.format(f'{attribute}="Bert"')))
    assert performed_ids(timeline) == ["s", "g", "f"]
    assert {drop.behaviour.id: drop.reason for drop in timeline.dropped} == dict.fromkeys("th", "Amber performs it") | {
        "h": "amber performs it"
    }
    assert [n.text for n in timeline.notices] == [
        "speech 't' is skipped: Amber performs it",
        "head 'h' is skipped: amber performs it",
    ]


def test_sync_references_to_behaviours_of_unperformed_agents_are_resolved() -> None:
    times = {
        timed_behaviour.behaviour.id: timed_behaviour.times
        for timed_behaviour in timed(parse(TWO_AGENTS.format('agent="Bert"'))).timed
    }
    assert times["g"]["stroke"] == pytest.approx(times["s"]["end"] + 1.0)
    assert times["f"]["start"] == pytest.approx(times["s"]["m"])


def test_performer_option_selects_the_performed_agent() -> None:
    timeline = timed(parse(TWO_AGENTS.format('agent="Bert"'), performer="AMBER"))
    assert performed_ids(timeline) == ["t", "h"]
    assert performed_ids(timed(parse(TWO_AGENTS.format('agent="Bert"'), performer="Cleo"))) == []


def test_first_agent_in_the_document_is_performed_by_default_with_a_notice() -> None:
    text = '<bml id="b"><head id="h" lexeme="NOD" agent="A"/><head id="i" lexeme="NOD" agent="B" start="1"/></bml>'
    block = parse(text)
    assert performed_ids(timed(block)) == ["h"]
    assert "this robot performs A; choose another with --character" in block.notices[0].text
    assert performed_ids(timed(parse(text, performer="B"))) == ["i"]
    assert parse('<bml id="b"><head id="h" lexeme="NOD" agent="A"/></bml>').notices == ()


def test_infeasible_behaviour_of_another_agent_is_dropped_first_although_required() -> None:
    loop = (
        '<bml id="b" agent="A"><required><head id="h" lexeme="NOD" agent="B" start="i:end"/></required>'
        '<head id="i" lexeme="NOD" start="h:end"/></bml>'
    )
    timeline = timed(parse(loop))
    assert [drop.behaviour.id for drop in timeline.dropped] == ["h", "i"]
