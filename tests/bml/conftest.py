"""Speech for tests: every letter takes as long as any other."""

from collections.abc import Callable

import pytest

from kinesic.bml.block import Block, Speech, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

SECONDS_PER_LETTER = 0.1


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
    """An utterance for every speech of a block."""
    return _spoken


@pytest.fixture
def timed() -> Callable[[str], Timeline]:
    """The timeline of the inside of a BML 1.0 block called `b`."""

    def timeline(inside: str) -> Timeline:
        block = parse(f'<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">{inside}</bml>')
        return schedule(block, _spoken(block), {})

    return timeline
