"""Saved documents and validated gestures over the wire, without side effects."""

import json
import re
from dataclasses import replace

import pytest

from kinesic.cli.live.studio import StudioPlanning
from kinesic.cli.options import Planning
from kinesic.serve.wire.quotas import Quotas

from ..conftest import running

pytestmark = pytest.mark.realtime

ROBOT = '[robot]\nname = "mine"\nextends = "upper22"\n'
GESTURE = 'category = "beat"\n\n[[gesture]]\nid = "{}"\nkeys = [{{ right = {{ at = [0.5, {}, 0.5] }} }}]\n'
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"><head id="n" lexeme="NOD" start="0"/></bml>'
SAVED_GESTURE_BML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"><gesture id="g" lexeme="{}" start="0"/></bml>'
)


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    """Server whose document folder also contains its robot file."""
    folder = tmp_path_factory.mktemp("documents")
    (folder / "mine.toml").write_text(ROBOT)
    (folder / "names.toml").write_text('[synonyms]\nbeat = ["thump"]\n')
    known = replace(StudioPlanning.of(Planning(str(folder / "mine.toml"), "neutral", {})), folder=folder)
    with running(Quotas(rate=1000.0, burst=1000), folder=folder, make_setup=known.set_up) as server:
        yield server, folder


def saved(client, name: str, text: str) -> str:
    """Return the reason of a refused save, or an empty text."""
    client.do("save", name=name, text=text)
    while True:
        answer = json.loads(client.receive(30))
        if answer["told"] in ("saved", "refused"):
            return answer.get("why", "")


@pytest.mark.parametrize("surrogate", [rb"\udcff", b"\xed\xb3\xbf", b"\xff"])
def test_lone_surrogates_and_invalid_bytes_in_any_request_are_refused_and_write_no_file(studio, surrogate):
    server, folder = studio
    before = set(folder.rglob("*"))
    messages = [
        b'{"do": "save", "name": "%b.bml", "text": "x", "id": 1}',
        b'{"do": "save", "name": "a.bml", "text": "%b", "id": 1}',
        b'{"do": "open", "name": "%b.bml", "id": 1}',
        b'{"do": "versions", "name": "%b.bml", "id": 1}',
        b'{"do": "backup", "key": "abcdefgh", "name": "%b", "revision": "", "text": "x", "id": 1}',
        b'{"do": "backup", "key": "abcdefgh", "name": "a", "revision": "", "text": "%b", "id": 1}',
        b'{"do": "backup", "key": "%b", "name": "a", "revision": "", "text": "x", "id": 1}',
        b'{"do": "export", "bml": "%b", "format": "csv", "id": 1}',
        b'{"do": "gesture", "toml": "%b", "id": 1}',
        b'{"do": "author", "text": "%b", "id": 1}',
        b'{"id": "%b", "behaviours": [{"type": "head", "lexeme": "NOD"}]}',
    ]
    with server.client() as client:
        for message in messages:
            client.send_bytes(message.replace(b"%b", surrogate))
            answer = client.receive(30)
            assert answer is not None, message
            assert "saved" not in answer
            assert "backed_up" not in answer
        client.do("ping")
        while "pong" not in (answer := client.receive(30) or ""):
            assert answer, "the server is gone"
    assert set(folder.rglob("*")) - before == set()


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("mine.toml", ROBOT + "[collision]\nclearance = -5.0\n", "other data than gestures"),
        ("mine.toml", GESTURE.format("mine", 0.3), "other data than gestures"),
        ("names.toml", GESTURE.format("mine", 0.3), "other data than gestures"),
        ("robot.toml", ROBOT, "it has robot"),
        ("style.toml", "spatial = 0.5\n", "missing required field `temporal`"),
        ("targets.toml", "cup = [0.0, 0.0, 0.0]\n", "it has cup"),
        ("names2.toml", GESTURE.format("mine", 0.3) + '[synonyms]\nmine = ["yes"]\n', "it has synonyms"),
        ("empty.toml", "# nothing\n", "no gesture"),
        ("digits.toml", "category = " + "1" * 5000, "not TOML"),
        ("dotted.toml", ".".join(["a"] * 90_000) + " = 1", "more than 32 parts"),
        ("large.toml", "#" * 200_001, "at most 200000"),
        ("far.toml", GESTURE.format("beat", "1e308"), "arm lengths up"),
        ("wrong.toml", GESTURE.format("mine", 0.3).replace("right", "rihgt"), "rihgt"),
    ],
)
def test_invalid_gesture_file_is_refused_and_not_written(studio, name, text, why):
    server, folder = studio
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with server.client() as client:
        assert why in saved(client, name, text)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_saved_gesture_can_be_used_by_the_next_block(studio):
    server, folder = studio
    with server.client() as client:
        for height in (0.3, 0.4):
            text = GESTURE.format("own_beat", height)
            assert saved(client, "own.toml", text) == ""
            assert (folder / "own.toml").read_text() == text
            messages = "".join(client.perform(SAVED_GESTURE_BML.format(f"own{int(10 * height)}", "own_beat")))
            assert "warningFeedback" not in messages, messages


def test_incomplete_bml_document_is_saved_unchanged(studio):
    server, folder = studio
    with server.client() as client:
        assert saved(client, "draft.bml", "<bml> half a docum") == ""
    assert (folder / "draft.bml").read_text() == "<bml> half a docum"


def test_block_is_performed_while_another_client_keeps_saving_gesture_files(studio):
    server, _ = studio
    deaths = server.open.clients.session.planner.deaths
    with server.client() as saver, server.client() as client:
        for number in range(12):
            saver.do("save", name="again.toml", text=GESTURE.format("again", 0.3 + 0.01 * (number % 2)), id=number)
        messages = "".join(client.perform(NOD.format("meanwhile")))
        client.do("status")
        assert json.loads(client.receive(20))["planner"] == "warm"
    assert "warningFeedback" not in messages, messages
    assert re.search(r'id="meanwhile:end"', messages)
    assert server.open.clients.session.planner.deaths == deaths


def test_excess_document_requests_are_refused(studio):
    server, folder = studio
    (folder / "big.bml").write_text("x" * 900_000)
    with server.client() as client:
        for number in range(60):
            client.do("open", name="big.bml", id=number)
        while answer := client.receive(20):
            if "wait already" in answer or "were dropped" in answer:
                return
    pytest.fail("nobody said that documents wait already")
