"""Fixtures with speech of constant duration per letter."""

from collections.abc import Callable

import pytest

from kinesic.bml.block import Block, Speech, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

SECONDS_PER_LETTER = 0.1  # [s] spoken duration of each letter
# speech with a mark before `big`
SPEECH_XML = '<speech id="s"><text>Hello <sync id="m"/>big world</text></speech>'


def gesture(name: str, syncs: str = "") -> str:
    """Return a beat with the given sync attributes."""
    return f'<gesture id="{name}" lexeme="BEAT" {syncs}/>'


def at(timeline: Timeline, sync: str) -> float:
    """Return the time [s] of a sync point such as `g:stroke`."""
    behaviour, _, point = sync.partition(":")
    (times,) = (timed.times for timed in timeline.timed if timed.behaviour.id == behaviour)
    return times[point]


def _spoken(block: Block) -> dict[str, Utterance]:
    return {
        behaviour.id: Utterance(
            SECONDS_PER_LETTER * len(behaviour.action.script.text),
            {mark.name: SECONDS_PER_LETTER * mark.position for mark in behaviour.action.script.marks},
        )
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Speech)
    }


@pytest.fixture
def spoken() -> Callable[[Block], dict[str, Utterance]]:
    """Return a function that makes an utterance for each speech."""
    return _spoken


@pytest.fixture
def timed() -> Callable[[str], Timeline]:
    """Return a function that schedules the content of a BML 1.0 block."""

    def timeline(inside: str) -> Timeline:
        block = parse(f'<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">{inside}</bml>')
        return schedule(block, _spoken(block), {})

    return timeline
