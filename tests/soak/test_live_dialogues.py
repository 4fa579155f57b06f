"""Ten dialogues with a server in real time."""

import os
from collections.abc import Iterator

import numpy as np
import pytest

from kinesic.bench.conversation.dialogues import write_dialogue
from kinesic.session.setup import set_up
from kinesic.speech.espeak_pool import espeak_fault

from .dialogue_measures import MAX_RATIO, Recording, Totals, measure
from .live_dialogue import LiveServer, live_server, perform_live

SEEDS = range(5000, 5010)  # seeds of dialogues that are used for nothing else
MAX_LOAD = 4.0  # load average above which delays are not judged

pytestmark = pytest.mark.soak


@pytest.fixture
def server() -> Iterator[LiveServer]:
    if fault := espeak_fault():
        pytest.skip(fault)
    with live_server() as result:
        yield result


def test_ten_live_dialogues_meet_the_goals_of_conversations_within_all_limits(server: LiveServer):
    totals, setup = Totals(), set_up()
    performed = [perform_live(server, write_dialogue(seed), seed) for seed in SEEDS]
    recording = Recording.of(setup, *server.recorded())
    for done in performed:
        measure(done, recording, totals)
    lines = "\n".join(totals.lines())
    assert max(recording.limit_ratios().values()) <= MAX_RATIO, recording.limit_ratios()
    assert totals.missed <= 0.05 * totals.attempts, lines
    assert totals.false_yields <= 0.05 * totals.others, lines
    if os.getloadavg()[0] <= MAX_LOAD:
        assert np.percentile(totals.sound_off, 95) <= 0.35, lines
        assert np.percentile(totals.arms_still, 95) <= 1.0, lines
        assert np.median(totals.turn_ends[False]) <= 0.8, lines
