"""Exports: a document's performance as files of other programs, as clients get them."""

import io
import json
import os
import tempfile
import wave
from base64 import b64decode
from pathlib import Path
from typing import get_args
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

from kinesic.bml.block import BOUNDS
from kinesic.body.config import ConfigError
from kinesic.cli.live.serve import WRITERS
from kinesic.serve.desk import export as exporting
from kinesic.serve.desk.draft import plan_draft
from kinesic.serve.desk.drafter import answer_draft
from kinesic.serve.desk.export import export
from kinesic.serve.wire.questions import ExportQuestion, Format, GestureQuestion
from kinesic.serve.wire.quotas import USUAL

WORDS = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc"><speech id="s"><text>Say one.</text></speech>'
    '<head id="h" lexeme="NOD" start="s:start"/></bml>'
)

NAMED = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id={}><head id="h" lexeme="NOD" start="0"/></bml>'
GESTURE = 'category = "beat"\n\n[[gesture]]\nid = "mine"\nkeys = [{ right = { at = [0.5, 0.3, 0.5] } }]\n'
HOSTILE_IDS = ("{place}/dear", "../{name}/dear", "dear", "a" * 500, "\N{GRINNING FACE}" * 90, "..", "/", "con", "a\\b")


@pytest.fixture(scope="module")
def planned(speaking_setup):
    return plan_draft(WORDS, (), speaking_setup, bounds=BOUNDS, longest=60.0)


def test_motions_are_those_of_the_plan(planned):
    arrays = np.load(io.BytesIO(b64decode(export(planned, "npz"))))
    assert tuple(arrays["names"]) == planned.setup.robot.skeleton.names
    assert np.allclose(arrays["angles"], planned.trajectory.sample(arrays["times"])[0])
    table = b64decode(export(planned, "csv")).decode().splitlines()
    assert table[0].startswith("time_s,")
    assert len(table) == 1 + len(arrays["times"])
    assert b64decode(export(planned, "bap")).startswith(b"3.2 doc ")


def test_the_voice_lasts_as_long_as_the_performance(planned):
    with wave.open(io.BytesIO(b64decode(export(planned, "wav")))) as file:
        assert file.getnframes() / file.getframerate() == pytest.approx(planned.duration, abs=0.05)
        assert np.ptp(np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(int)) > 1000


def test_where_nothing_is_heard_there_is_no_voice(upper22_setup):
    silent = plan_draft(WORDS, (), upper22_setup, bounds=BOUNDS, longest=60.0)
    with pytest.raises(ConfigError, match="nothing is heard"):
        export(silent, "wav")


def test_a_file_that_is_too_large_is_refused_with_its_size(planned, monkeypatch):
    monkeypatch.setattr(exporting, "MOST_BYTES", 1000)
    with pytest.raises(ConfigError, match="at most 1000"):
        export(planned, "npz")


def test_a_scene_is_written_by_whoever_knows_how_and_else_it_is_said_who_does(planned):
    scene = b64decode(export(planned, "glb", WRITERS))
    assert scene.startswith(b"glTF")
    assert b'"animations"' in scene
    with pytest.raises(ConfigError, match=r"kinesic plan --out scene\.glb"):
        export(planned, "glb")


def asked(id_: str, format_: str, setup) -> dict:
    """What a client is answered that asks for an export of a block of this id."""
    question = ExportQuestion(NAMED.format(quoteattr(id_)), format_, id=1)
    return json.loads(answer_draft(question, setup, USUAL, writers=WRITERS))


@pytest.mark.parametrize("format_", get_args(Format))
def test_no_id_of_a_block_leads_to_a_file_outside(tmp_path, monkeypatch, upper22_setup, format_):
    mine, temporary = tmp_path / "mine", tmp_path / "temporary"
    mine.mkdir()
    temporary.mkdir()
    letter = mine / f"dear.{format_}"
    letter.write_text("dear")
    (temporary / f"dear.{format_}").symlink_to(letter)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    monkeypatch.chdir(mine)
    for hostile in HOSTILE_IDS:
        told = asked(hostile.format(place=mine, name="mine"), format_, upper22_setup)
        assert told["told"] == "export"
        if format_ == "wav":
            assert "nothing is heard" in told["error"]["text"]
        else:
            assert len(b64decode(told["data"])) > 100
            assert Path(told["name"]).name == told["name"]
            assert told["name"].isascii()
            assert told["name"].endswith(f".{format_}")
    assert letter.read_text() == "dear"
    assert os.listdir(mine) == [letter.name]
    assert os.listdir(temporary) == [letter.name]


def test_an_export_has_the_name_of_its_block_as_far_as_that_is_plain(planned, upper22_setup):
    assert asked("doc", "csv", upper22_setup)["name"] == "doc.csv"
    assert asked("/home/me/my data", "csv", upper22_setup)["name"] == "home_me_my_data.csv"
    assert asked("con", "csv", upper22_setup)["name"] == "con_.csv"
    assert asked("\N{GRINNING FACE}", "bap", upper22_setup)["name"] == "performance.bap"


def test_without_a_folder_for_temporary_files_the_client_is_answered(tmp_path, monkeypatch, upper22_setup):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    assert "cannot write its temporary files" in asked("doc", "csv", upper22_setup)["error"]["text"]
    question = GestureQuestion(toml=GESTURE, id=2)
    told = json.loads(answer_draft(question, upper22_setup, USUAL))
    assert "cannot write its temporary files" in told["error"]["text"]
    assert str(tmp_path) not in json.dumps(told)
