"""Warnings name exactly the sync points moved by over 10 ms."""

import xml.etree.ElementTree as ElementTree
from collections import Counter

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.report import feedback
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BLOCK_XML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'

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
def test_feedback_warnings_name_exactly_the_sync_points_moved_by_over_10_ms(known, asked, nod):
    lines = [
        f'<gesture id="g{k}" lexeme="{lexeme}" mode="{mode}" stroke="{time}"/>'
        for k, (lexeme, mode, time) in enumerate(asked)
    ]
    planned = plan(BLOCK_XML.format("".join([*lines, f'<head id="h" lexeme="NOD" start="{nod}"/>'])), known)
    messages = [ElementTree.fromstring(message) for message in feedback(planned)]
    counts = Counter(
        (message.get("id"), sync)
        for message in messages
        if message.text and " planned at " in message.text
        for sync in message.text.partition(" requested at ")[0].split(" and ")
    )
    moved = [sync for sync in planned.syncs if abs(sync.planned - sync.requested) > SHIFT_TO_WARN]
    assert counts == Counter((f"b:{sync.behaviour}", sync.sync) for sync in moved)
