"""Server with real sockets: feedback, limits and uninterrupted performance."""

import json
import re
import socket
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from websockets.sync.client import connect

from kinesic.body.command import COMMAND_RATE
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up

pytestmark = pytest.mark.realtime

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
BEAT_COUNT = 2
NOD = '<head id="h" lexeme="NOD" start="0" end="0.5"/>'
SEVERAL_BEATS = "".join(
    f'<gesture id="g{k}" lexeme="BEAT" mode="LEFT_HAND" stroke="{0.8 + 0.4 * k}"/>' for k in range(BEAT_COUNT)
)
NOD_POINTS = [
    "start",
    "h:start",
    "h:ready",
    "h:strokeStart",
    "h:stroke",
    "h:strokeEnd",
    "h:relax",
    "relax",
    "h:end",
    "end",
]


@cache
def known() -> Setup:
    """Setup of the server's planner, loaded once."""
    return set_up()


def progress(messages, name):
    """Return the progress feedback of a block in order."""
    results = (re.search(rf'<(?:block|syncPoint)Progress[^>]* id="{name}:([^"]*)"', message) for message in messages)
    return [match[1] for match in results if match]


def undisturbed(commands):
    """Return whether all ticks were sent once and without steps."""
    limits = known().limits
    ticks = np.rint([COMMAND_RATE * command.time for command in commands]).astype(int)
    angles = np.array([command.angles for command in commands])
    speeds = np.abs(np.diff(angles, axis=0)) * COMMAND_RATE
    jumps = np.abs(np.diff(angles, 2, axis=0)) * COMMAND_RATE**2
    return (
        (np.diff(ticks) == 1).all()
        and (speeds <= 1.01 * limits.speed).all()
        and (jumps <= 1.01 * limits.acceleration).all()
    )


def seen(server):
    return [command for _, command in server.witness.commands]


def test_block_is_predicted_performed_and_reported_in_order(server):
    with server.client() as client:
        messages = list(client.perform(BLOCK.format("ordered", NOD)))
    assert "<predictionFeedback" in messages[0]
    assert progress(messages, "ordered") == NOD_POINTS
    times = [float(time) for message in messages for time in re.findall(r'globalTime="([^"]*)"', message)]
    assert times == sorted(times)
    assert undisturbed(seen(server))


def test_nod_moves_the_head_and_ends_at_rest(server):
    with server.client() as client:
        times = [
            float(result[1])
            for item in client.perform(BLOCK.format("moving", NOD))
            if (result := re.search(r'globalTime="([^"]*)"', item))
        ]
    rest = known().robot.skeleton.rest
    moved = [np.abs(item.angles - rest).max() for item in seen(server) if times[0] <= item.time <= times[-1]]
    assert max(moved) > np.radians(5.0)
    assert moved[0] < 1e-6
    assert moved[-1] < 1e-3


def test_websocket_client_gets_the_feedback_of_all_sync_points_of_a_nod(server):
    with connect(f"ws://127.0.0.1:{server.port}") as client:
        client.send(BLOCK.format("web", NOD))
        messages = []
        while progress(messages, "web")[-1:] != ["end"]:
            messages.append(client.recv(20))
    assert progress(messages, "web") == NOD_POINTS


def test_websocket_client_may_send_fragments_and_binary_data(server):
    with connect(f"ws://127.0.0.1:{server.port}") as client:
        client.send(['{"do": "pi', 'ng", "id"', ': "x"}'])
        assert json.loads(client.recv(20)) == {"told": "pong", "id": "x"}
        client.send(b'{"do": "ping"}')
        assert json.loads(client.recv(20)) == {"told": "pong", "id": ""}


def test_client_that_stops_sending_still_gets_all_feedback(server):
    with socket.create_connection(("127.0.0.1", server.port), 20) as plain:
        plain.sendall(BLOCK.format("half-closed", NOD).encode() + b"\0")
        plain.shutdown(socket.SHUT_WR)
        stream = plain.makefile("rb").read()
    assert progress(stream.decode().split("\0"), "half-closed") == NOD_POINTS


def test_block_of_a_disconnected_client_continues(server, becomes):
    with server.client() as staying:
        with server.client() as going:
            going.send(BLOCK.format("left", SEVERAL_BEATS))
        messages = list(staying.perform(BLOCK.format("stays", NOD)))
        assert progress(messages, "stays") == NOD_POINTS
    assert becomes(server.open.clients.session.loop.is_settled)
    assert undisturbed(seen(server))


def test_invalid_blocks_are_answered_and_disturb_no_client(server):
    bad = ["<bml", "nonsense < here", "", "<a/>", '<bml id="x"><gesture stroke="nan"/></bml>', "{}", "\ufffe<bml/>"]
    with server.client() as good, server.client() as other:
        good.send(BLOCK.format("good", SEVERAL_BEATS))
        for text in bad:
            if text.strip():
                other.send("<" + text if not text.startswith(("<", "{")) else text)
        answers = [other.receive(20) for text in bad if text.strip()]
        assert all("warningFeedback" in answer for answer in answers)
        messages = []
        while progress(messages, "good")[-1:] != ["end"]:
            messages.append(good.receive(20))
    assert len([message for message in messages if "syncPointProgress" in message]) == BEAT_COUNT * 7
    assert undisturbed(seen(server))


def test_block_whose_id_extends_the_id_of_another_block_gets_its_feedback(server):
    with server.client() as client, server.client() as other:
        client.send(BLOCK.format("twin", NOD))
        assert "<predictionFeedback" in client.receive(20)
        messages = list(other.perform(BLOCK.format("twins", NOD)))
    assert progress(messages, "twins")[-1] == "end"


def test_server_serves_two_hundred_simultaneous_connections(server):
    clients = [server.client() for _ in range(200)]
    try:
        clients[0].send(BLOCK.format("crowd", NOD))
        for number, client in enumerate(clients):
            client.do("ping", id=str(number))
        for number, client in enumerate(clients[1:], 1):
            assert json.loads(client.receive(20))["id"] == str(number)
        messages = []
        while progress(messages, "crowd")[-1:] != ["end"]:
            messages.append(clients[0].receive(20))
        assert progress(messages, "crowd") == NOD_POINTS
    finally:
        for client in clients:
            client.close()
    assert undisturbed(seen(server))


def test_client_that_reads_slowly_loses_only_its_own_messages(server, becomes):
    clients = server.open.clients._clients
    with server.client() as quick, server.client() as slow:
        quick.do("ping")
        quick.receive(20)
        for _ in range(60):
            slow.send("<" + "a" * 200)
        messages = list(quick.perform(BLOCK.format("beside", NOD)))
        assert progress(messages, "beside") == NOD_POINTS
        assert all(len(client.output) <= server.open.clients.rules.unread for client in clients.values())


def test_status_reports_the_server_state(server):
    with server.client() as client:
        client.do("status")
        data = json.loads(client.receive(20))
    assert data["told"] == "status"
    assert data["clients"] >= 1
    assert data["planner"] == "warm"


def test_client_sending_endless_blanks_is_disconnected(server):
    with socket.create_connection(("127.0.0.1", server.port), 20) as blank:
        blank.sendall(b" " * 70_000)
        assert blank.makefile("rb").read() == b""


def test_server_raises_and_lowers_the_brows_at_their_scheduled_times(server):
    face = '<faceLexeme id="f" lexeme="RAISE_BROWS" amount="1" start="0" attackPeak="0.3" relax="0.6" end="0.9"/>'
    with server.client() as client:
        messages = list(client.perform(BLOCK.format("face", face)))
    begin = min(float(time) for message in messages for time in re.findall(r' globalTime="([^"]*)"', message))
    shown = {round(item.time - begin, 2): dict(item.face) for item in seen(server) if item.time >= begin}
    brows = {time: units.get("L1", 0.0) for time, units in shown.items()}
    assert max(brows.values()) == pytest.approx(max(value for time, value in brows.items() if 0.2 < time < 0.7))
    assert max(brows.values()) > 0.5
    assert brows[max(brows)] < 0.01


def test_server_refuses_an_unknown_style_and_accepts_a_valid_style(server):
    with server.client() as client:
        client.do("style", style="nonesuch")
        assert "nonesuch" in json.loads(client.receive(20))["why"]
        client.do("style", style="calm", set=["power=0.5"])
        messages = list(client.perform(BLOCK.format("calmly", NOD)))
        client.do("style", style="neutral")
    assert progress(messages, "calmly")[-1] == "end"


def test_interrupting_all_blocks_ends_the_playing_block_early(server):
    with server.client() as client:
        client.send(BLOCK.format("cut-short", SEVERAL_BEATS))
        messages = []
        while not progress(messages, "cut-short"):
            messages.append(client.receive(20))
        client.do("interrupt")
        while progress(messages, "cut-short")[-1] != "end":
            messages.append(client.receive(20))
    assert len(progress(messages, "cut-short")) < 5 * BEAT_COUNT
    assert undisturbed(seen(server))


def test_emergency_stop_is_acknowledged_while_documents_wait(server, becomes):
    with server.client() as busy, server.client() as guard:
        for number in range(6):
            busy.send(BLOCK.format(f"busy{number}", SEVERAL_BEATS))
        busy.receive(20)
        loop = server.open.clients.session.loop
        stops = loop.stop_count
        guard.stop()
        assert json.loads(guard.receive(20)) == {"told": "stopped"}
        assert becomes(lambda: loop.is_stopped and loop.stop_count == stops + 1 and loop.is_settled())
        still = len(seen(server))
        guard.send(BLOCK.format("refused", NOD))
        assert "rule stopped" in guard.receive(20)
        assert becomes(lambda: len(seen(server)) > still + 50)
        held = np.array([command.angles for command in seen(server)[still:]])
        assert np.ptp(held, axis=0).max() < 1e-9
        guard.do("resume")
        messages = list(guard.perform(BLOCK.format("resumed", NOD)))
        assert progress(messages, "resumed") == NOD_POINTS
    assert undisturbed(seen(server))


def test_dead_planner_is_replaced_while_the_motion_continues(server, becomes):
    session = server.open.clients.session
    with server.client() as client:
        client.send(BLOCK.format("survivor", SEVERAL_BEATS))
        messages = []
        while not progress(messages, "survivor"):
            messages.append(client.receive(20))
        session.planner._working.child.kill()
        while progress(messages, "survivor")[-1] != "end":
            messages.append(client.receive(20))
        assert becomes(lambda: session.planner.is_free)
        messages = list(client.perform(BLOCK.format("afterwards", NOD)))
    assert progress(messages, "afterwards") == NOD_POINTS
    assert undisturbed(seen(server))


def test_block_with_overlong_planning_is_refused(server, becomes, monkeypatch):
    session = server.open.clients.session
    with server.client() as client, server.client() as other:
        client.send(BLOCK.format("goes-on", SEVERAL_BEATS))
        messages = []
        while not progress(messages, "goes-on"):
            messages.append(client.receive(20))
        monkeypatch.setattr(session.planner, "_rules", replace(server.open.clients.rules, planning=1e-4))
        other.send(BLOCK.format("too-hard", SEVERAL_BEATS))
        results = [other.receive(20)]
        while "warningFeedback" not in results[-1]:
            results.append(other.receive(20))
        assert "rule planning" in results[-1]
        monkeypatch.undo()
        while progress(messages, "goes-on")[-1] != "end":
            messages.append(client.receive(20))
        assert becomes(lambda: session.planner.is_free)
    assert undisturbed(seen(server))


def test_strokes_of_a_block_with_six_gestures_are_reported_in_order(server):
    many = "".join(
        f'<gesture id="g{k}" lexeme="BEAT" mode="{("LEFT", "RIGHT")[k % 2]}_HAND" stroke="{0.8 + 0.5 * k}"/>'
        for k in range(6)
    )
    with server.client() as client:
        messages = list(client.perform(BLOCK.format("large", many)))
    strokes = [point for point in progress(messages, "large") if point.endswith(":stroke")]
    assert strokes == [f"g{k}:stroke" for k in range(6)]
    assert undisturbed(seen(server))


def test_block_performs_all_strokes_although_its_expressivity_amount_changes_meanwhile(server):
    with server.client() as client:
        client.send(BLOCK.format("wide", SEVERAL_BEATS))
        messages = []
        while not progress(messages, "wide"):
            messages.append(client.receive(20))
        client.do("style", amount=0.9, block="wide")
        while progress(messages, "wide")[-1] != "end":
            messages.append(client.receive(20))
    assert sum(point.endswith(":stroke") for point in progress(messages, "wide")) == BEAT_COUNT
    assert undisturbed(seen(server))
