"""Whatever is asked: each sync point that moves by more than 10 ms is warned of, and no other."""

import xml.etree.ElementTree as ElementTree
from collections import Counter

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinesic.controller.perform import plan, set_up
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.report import feedback

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'

times = st.floats(0, 3).map(lambda time: round(time, 3))
gestures = st.lists(
    st.tuples(st.sampled_from(["beat", "large", "up", "belly"]), st.sampled_from(["LEFT_HAND", "BOTH_HANDS"]), times),
    min_size=1,
    max_size=3,
)


@pytest.fixture(scope="module")
def known():
    return set_up()


@settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(gestures, times)
def test_warned_if_and_only_if_moved(known, asked, nod):
    lines = [
        f'<gesture id="g{k}" lexeme="{lexeme}" mode="{mode}" stroke="{time}"/>'
        for k, (lexeme, mode, time) in enumerate(asked)
    ]
    planned = plan(ROOT.format("".join([*lines, f'<head id="h" lexeme="NOD" start="{nod}"/>'])), known)
    messages = [ElementTree.fromstring(message) for message in feedback(planned)]
    told = Counter((m.get("id"), m.text.split()[0]) for m in messages if m.text and " is planned at " in m.text)
    moved = [sync for sync in planned.syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN]
    assert told == Counter((f"b:{sync.behaviour}", sync.sync) for sync in moved)
