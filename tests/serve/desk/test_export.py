"""Exports: a document's performance as files of other programs, as clients get them."""

import io
import wave
from base64 import b64decode

import numpy as np
import pytest

from kinesic.bml.block import BOUNDS
from kinesic.body.config import ConfigError
from kinesic.cli.live.serve import WRITERS
from kinesic.serve.desk import export as exporting
from kinesic.serve.desk.draft import plan_draft
from kinesic.serve.desk.export import export

WORDS = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc"><speech id="s"><text>Say one.</text></speech>'
    '<head id="h" lexeme="NOD" start="s:start"/></bml>'
)


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
