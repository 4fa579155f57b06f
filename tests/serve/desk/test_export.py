"""Exports of a document's performance to files of other programs."""

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

from kinesic.bml.block import DEFAULT_BOUNDS
from kinesic.body.config import ConfigError
from kinesic.cli.live.serve import EXPORT_WRITERS
from kinesic.serve.desk import export as exporting
from kinesic.serve.desk.draft import plan_draft
from kinesic.serve.desk.drafter import answer_draft
from kinesic.serve.desk.export import export
from kinesic.serve.wire.questions import ExportQuestion, Format, GestureQuestion
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS

SPOKEN_DOCUMENT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc"><speech id="s"><text>Say one.</text></speech>'
    '<head id="h" lexeme="NOD" start="s:start"/></bml>'
)

NOD_WITH_ID = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id={}><head id="h" lexeme="NOD" start="0"/></bml>'
GESTURE = 'category = "beat"\n\n[[gesture]]\nid = "mine"\nkeys = [{ right = { at = [0.5, 0.3, 0.5] } }]\n'
HOSTILE_IDS = ("{place}/dear", "../{name}/dear", "dear", "a" * 500, "\N{GRINNING FACE}" * 90, "..", "/", "con", "a\\b")


@pytest.fixture(scope="module")
def planned(speaking_setup):
    return plan_draft(SPOKEN_DOCUMENT, (), speaking_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)


def test_exported_motion_equals_the_plan(planned):
    arrays = np.load(io.BytesIO(b64decode(export(planned, "npz"))))
    assert tuple(arrays["names"]) == planned.setup.robot.skeleton.names
    assert np.allclose(arrays["angles"], planned.trajectory.sample(arrays["times"])[0])
    table = b64decode(export(planned, "csv")).decode().splitlines()
    assert table[0].startswith("time_s,")
    assert len(table) == 1 + len(arrays["times"])
    assert b64decode(export(planned, "bap")).startswith(b"3.2 doc ")


def test_exported_wav_has_sound_and_the_duration_of_the_plan(planned):
    with wave.open(io.BytesIO(b64decode(export(planned, "wav")))) as file:
        assert file.getnframes() / file.getframerate() == pytest.approx(planned.duration, abs=0.05)
        assert np.ptp(np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(int)) > 1000


def test_wav_export_of_a_plan_without_audio_is_refused(upper22_setup):
    silent = plan_draft(SPOKEN_DOCUMENT, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)
    with pytest.raises(ConfigError, match="there is no audio"):
        export(silent, "wav")


def test_oversized_export_is_refused_with_its_size(planned, monkeypatch):
    monkeypatch.setattr(exporting, "MAX_FILE_SIZE", 1000)
    with pytest.raises(ConfigError, match="at most 1000"):
        export(planned, "npz")


def test_gltf_export_without_a_writer_suggests_the_plan_command(planned):
    scene = b64decode(export(planned, "glb", EXPORT_WRITERS))
    assert scene.startswith(b"glTF")
    assert b'"animations"' in scene
    with pytest.raises(ConfigError, match=r"kinesic plan --out scene\.glb"):
        export(planned, "glb")


def asked(id_: str, format_: str, setup) -> dict:
    """Return the answer to an export request for a block with this id."""
    question = ExportQuestion(NOD_WITH_ID.format(quoteattr(id_)), format_, id=1)
    return json.loads(answer_draft(question, setup, DEFAULT_QUOTAS, writers=EXPORT_WRITERS))


@pytest.mark.parametrize("format_", get_args(Format))
def test_block_id_cannot_escape_the_export_folder(tmp_path, monkeypatch, upper22_setup, format_):
    mine, temporary = tmp_path / "mine", tmp_path / "temporary"
    mine.mkdir()
    temporary.mkdir()
    letter = mine / f"dear.{format_}"
    letter.write_text("dear")
    (temporary / f"dear.{format_}").symlink_to(letter)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    monkeypatch.chdir(mine)
    for hostile in HOSTILE_IDS:
        result = asked(hostile.format(place=mine, name="mine"), format_, upper22_setup)
        assert result["told"] == "export"
        if format_ == "wav":
            assert "there is no audio" in result["error"]["text"]
        else:
            assert len(b64decode(result["data"])) > 100
            assert Path(result["name"]).name == result["name"]
            assert result["name"].isascii()
            assert result["name"].endswith(f".{format_}")
    assert letter.read_text() == "dear"
    assert os.listdir(mine) == [letter.name]
    assert os.listdir(temporary) == [letter.name]


def test_name_of_an_exported_file_is_derived_from_the_block_id(planned, upper22_setup):
    assert asked("doc", "csv", upper22_setup)["name"] == "doc.csv"
    assert asked("/home/me/my data", "csv", upper22_setup)["name"] == "home_me_my_data.csv"
    assert asked("con", "csv", upper22_setup)["name"] == "con_.csv"
    assert asked("\N{GRINNING FACE}", "bap", upper22_setup)["name"] == "performance.bap"


def test_missing_temporary_folder_is_reported_as_the_error_of_export_and_gesture_queries(
    tmp_path, monkeypatch, upper22_setup
):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    assert "cannot write its temporary files" in asked("doc", "csv", upper22_setup)["error"]["text"]
    question = GestureQuestion(toml=GESTURE, id=2)
    data = json.loads(answer_draft(question, upper22_setup, DEFAULT_QUOTAS))
    assert "cannot write its temporary files" in data["error"]["text"]
    assert str(tmp_path) not in json.dumps(data)
