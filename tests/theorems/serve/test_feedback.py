"""Each sync point is reported once, in order and never early."""

import re
from collections import Counter
from functools import lru_cache, partial
from itertools import chain, repeat

from hypothesis import given
from hypothesis import strategies as st

from kinesic.planning.setup import Setup
from kinesic.realizer.request import Message
from kinesic.serve.messages import DocumentRequest, Interruption, Restyling, Resumption
from kinesic.session.setup import set_up

from ...serve.simulated_server import SimulatedServer

BLOCK_XML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:bmla="http://www.asap-project.org/bmla" '
    'id="{}" composition="{}">{}</bml>'
)
BLOCK_CONTENTS = (
    "",
    '<faceLexeme id="f" lexeme="SMILE" start="0" end="0.4"/>',
    '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech>',
    '<head id="h" lexeme="NOD" start="0.02" repetition="2"/>',
    '<gaze id="z" target="left" start="0" end="0.6"/>',
    '<head id="h" lexeme="SHAKE" start="0"/><gesture id="g" lexeme="BEAT" start="0.1"/>',
    "".join(f'<head id="h{k}" lexeme="NOD" start="{0.5 * k}" end="{0.5 * k + 0.45}"/>' for k in range(5)),
    '<bmla:interrupt id="i" target="b0" start="0.2"/>',
    '<bmla:interrupt id="i" target="b1" include="h" start="0.1"/>',
)
TIME_RESOLUTION = 1e-6  # [s] resolution of the times in messages
CLIENT_COUNT = 3  # number of connected clients
MAX_DURATION = 90.0  # [s] longest duration of a test
PROGRESS_PATTERN = re.compile(r'<(?:block|syncPoint)Progress\b[^>]*? id="([^":]+):([^"]+)"[^>]*? globalTime="([^"]+)"')

delays = st.sampled_from((0.0, 0.001, 0.004, 0.009, 0.014, 0.019, 0.024, 0.04, 0.3))
pauses = st.sampled_from((0.0, 0.003, 0.011, 0.05, 0.13, 0.31, 0.7))
documents = st.tuples(
    st.just("send"),
    st.integers(1, CLIENT_COUNT),
    st.sampled_from(BLOCK_CONTENTS),
    st.sampled_from(("MERGE", "MERGE", "APPEND", "REPLACE")),
)
interruptions = st.tuples(st.just("interrupt"), st.integers(1, 4))
deeds = st.one_of(
    documents,
    documents,
    documents,
    interruptions,
    st.tuples(st.just("interrupt all")),
    st.tuples(st.just("style"), st.integers(1, 4), st.sampled_from(("calm", "neutral"))),
    st.tuples(st.just("stop"), st.sampled_from((0.0, 0.02, 0.2))),
    st.tuples(st.just("planner dies")),
    st.tuples(st.just("loop stalls"), st.sampled_from((0.1, 0.4))),
)
schedules = st.lists(st.tuples(pauses, deeds), min_size=4, max_size=14)


@lru_cache(maxsize=1)
def known() -> Setup:
    return set_up()


@given(schedules, st.lists(delays, min_size=1, max_size=12))
def test_each_sync_point_is_reported_once_in_order_and_never_early(schedule, late) -> None:
    server, sent, forgotten, time = SimulatedServer(known(), chain.from_iterable(repeat(late))), {}, set(), 0.0
    for pause, (deed, *details) in schedule:
        time += pause
        server.run(time)
        _do(server, time, deed, details, sent, forgotten)
    while server.is_busy() and server.clock.machine < MAX_DURATION:
        server.run(server.clock.machine + 0.5)
    assert not server.is_busy()
    _check(server, sent, forgotten)


def _do(server, time, deed, details, sent, forgotten) -> None:
    if deed == "send":
        client, inside, composition = details
        name = f"b{len(sent)}"
        sent[name] = client
        message = Message(BLOCK_XML.format(name, composition, inside), client, "<client>")
        server.request(time, lambda: DocumentRequest(message, server.loop.stop_count))
    elif deed == "interrupt":
        server.request(time, partial(Interruption, f"b{len(sent) - details[0]}"))
    elif deed == "interrupt all":
        server.request(time, partial(Interruption, None))
    elif deed == "style":
        back, style = details
        server.request(time, partial(Restyling, style, (), None, f"b{len(sent) - back}", 1))
    elif deed == "stop":
        server.at(time, server.loop.emergency_stop)
        server.at(time + details[0], lambda: server.request(time, lambda: Resumption(server.loop.stop_count)))
    elif deed == "loop stalls":
        server.at(time, partial(server.stall_loop, details[0]))
    else:
        forgotten.update(sent)  # Pending blocks are lost with their planner
        server.start_planner()


def _check(server, sent, forgotten) -> None:
    """Assert that points are unique, ordered per client and never early."""
    points: dict[str, list[str]] = {}
    latest = dict.fromkeys(range(1, CLIENT_COUNT + 1), 0.0)
    for received, client, message in server.told:
        for block, point, written in PROGRESS_PATTERN.findall(message):
            assert client == sent[block]
            points.setdefault(block, []).append(point)
            assert received >= float(written) - TIME_RESOLUTION, f"{block}:{point} is early"
            assert float(written) >= latest[client] - TIME_RESOLUTION, f"{block}:{point} is out of order"
            latest[client] = float(written)
    for block, own in points.items():
        assert max(Counter(own).values()) == 1, f"{block}: {own}"
        assert (own[0], own[-1]) == ("start", "end"), f"{block}: {own}"
    answered = {block for block in sent if any(f'id="{block}"' in m and "<warning" in m for _, _, m in server.told)}
    assert sent.keys() <= points.keys() | answered | forgotten
