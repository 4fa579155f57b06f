"""Client queries over the wire: receiver, ids and limits of the answers."""

import base64
import json
import os
import signal
import time

import numpy as np
import pytest

from kinesic.expressivity.lexicon.space import to_world
from kinesic.serve.wire.pages import WebFile

from ..test_handshake import answer

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="n" lexeme="NOD" start="0"/></bml>'


def told(client, what: str) -> dict:
    """Return the next answer of a kind."""
    return told_any(client, {what})


def told_any(client, kinds: set[str]) -> dict:
    """Return the next answer of several kinds."""
    while True:
        message = client.receive(20)
        assert message is not None
        if message.startswith("{") and json.loads(message)["told"] in kinds:
            return json.loads(message)


def test_valid_reach_query_is_answered_with_its_id_and_invalid_ones_are_refused(server, upper22_setup):
    target = to_world(upper22_setup.robot, "r", np.array([0.5, 0.3, 0.2])).tolist()
    with server.client() as client:
        client.do("reach", side="right", target=target, id=7)
        message = told(client, "reach")
        assert (message["id"], message["reached"], message["limits"], message["contact"]) == (7, True, [], None)
        client.do("reach", side="right", target=target, posture=[0.0])
        assert "22 hinges" in told(client, "refused")["why"]
        client.do("reach", side="right", target=[1e9, 0, 0])
        assert "target" in told(client, "refused")["why"]


def test_plan_query_does_not_move_the_robot(server, becomes):
    with server.client() as client, server.client() as other:
        assert becomes(lambda: other.do("status") or told(other, "status")["state"] == "resting")
        client.do("plan", bml=NOD + " " * 5000, id=3)  # longer than the limit of other control messages
        message = told(client, "plan")
        assert (message["id"], message["block"], [item["id"] for item in message["behaviours"]]) == (3, "b", ["n"])
        other.do("status")
        assert told(other, "status")["state"] == "resting"


def test_export_query_sent_with_a_plan_query_is_answered_and_invalid_exports_return_errors(server):
    with server.client() as client:
        client.do("export", bml=NOD, format="csv", id=4)
        client.do("plan", bml=NOD, id=5)
        results = {}
        while len(results) < 2:
            results |= {item["told"]: item for item in [told_any(client, {"export", "plan"})]}
        assert (results["export"]["id"], results["export"]["name"]) == (4, "b.csv")
        assert base64.b64decode(results["export"]["data"]).startswith(b"time_s,")
        assert results["plan"]["id"] == 5
        client.do("export", bml=NOD, format="wav", id=6)
        assert "there is no audio" in told(client, "export")["error"]["text"]
        client.do("export", bml="<bml", format="csv", id=7)
        assert told(client, "export")["error"]["line"] == 1
        client.do("export", bml=NOD, format="../../x")
        assert "format" in told(client, "refused")["why"]


def test_death_of_the_preview_process_fails_at_most_one_plan_query(server):
    with server.client() as client:
        client.do("plan", bml=NOD, id=1)
        told(client, "plan")
        drafter = server.open.clients.session.desk.drafter
        os.kill(drafter._process[0]._process.pid, signal.SIGKILL)
        client.do("plan", bml=NOD, id=2)
        answers = [told(client, "plan")]
        if "error" in answers[0]:
            client.do("plan", bml=NOD, id=3)
            answers.append(told(client, "plan"))
        assert answers[-1]["block"] == "b"


@pytest.mark.parametrize(
    ("helper", "question", "settings"),
    [
        ("drafter", "plan", {"bml": NOD + " " * 900_000}),
        ("_reacher", "reach", {"side": "left", "target": [0.3, 0.2, 0.3]}),
    ],
)
def test_stopped_helper_process_does_not_delay_the_pong_to_another_client(server, helper, question, settings):
    with server.client() as client, server.client() as other:
        client.do(question, **settings)
        told(client, question)
        process = getattr(server.open.clients.session.desk, helper)._process[0]._process
        os.kill(process.pid, signal.SIGSTOP)
        try:
            client.do(question, **settings)
            time.sleep(0.1)
            other.do("ping", id="now")
            assert json.loads(other.receive(5))["told"] == "pong"
        finally:
            os.kill(process.pid, signal.SIGCONT)
        told(client, question)


def test_newer_reach_queries_replace_waiting_reach_queries_and_the_last_is_answered(server):
    with server.client() as client:
        for k in range(50):
            client.do("reach", side="left", target=[0.3, 0.2, 0.01 * k], id=k)
        answers = [told(client, "reach") for _ in range(50)]
        assert {each["id"] for each in answers} == set(range(50))
        assert "angles" in answers[-1]
        assert any(each.get("outdated") for each in answers)


def test_style_paths_named_by_clients_are_refused_without_file_contents(server, tmp_path):
    (tmp_path / "secret.toml").write_text('password = "hunter2"')
    with server.client() as client:
        for block in ({}, {"block": "b"}):
            for style in (str(tmp_path / "secret.toml"), str(tmp_path / "gone.toml"), "../styles/calm"):
                client.do("style", style=style, **block)
                why = told(client, "refused")["why"]
                assert why.startswith(f"no style {style}"), why
                assert "password" not in why


def test_telemetry_subscription_sends_body_angles_until_its_rate_is_set_to_zero(server):
    with server.client() as client:
        client.do("watch", rate=50)
        first, second = told(client, "body"), told(client, "body")
        assert second["time"] > first["time"]
        assert len(second["angles"]) == len(second["planned"]) == 22
        client.do("watch", rate=40)  # replaces the first one
        told(client, "body")
        client.do("watch", rate=0)
        client.do("ping", id="last")
        told(client, "pong")
        time.sleep(0.1)  # time of four more reports
        client.do("ping", id="later")
        assert json.loads(client.receive(20))["told"] == "pong"


def test_only_configured_web_files_are_served(server, monkeypatch):
    files = {"/": WebFile("text/html", b"<p>hello")}
    monkeypatch.setattr(server.open.reception, "_files", files)

    def get(path: str, host: str = "localhost") -> bytes:
        request = f"GET {path} HTTP/1.1\r\nHost: {host}:{server.port}\r\n\r\n"
        return answer(server.port, request.encode())

    shown = get("/?x=1")
    assert shown.startswith(b"HTTP/1.1 200")
    assert shown.endswith(b"<p>hello")
    assert b"script-src 'self'" in shown
    assert b"unsafe" not in shown
    for path in ("/index.html", "/../pyproject.toml", "//etc/passwd", "/%2e%2e/pyproject.toml"):
        assert get(path).startswith(b"HTTP/1.1 404"), path
    assert get("/", host="evil.example").startswith(b"HTTP/1.1 421")
