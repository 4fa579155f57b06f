"""Clients name no files of the server's machine."""

import wave
from pathlib import Path

import pytest

pytestmark = pytest.mark.realtime

BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"><speech id="s" start="0"><text>Hello.</text>'
    '<description priority="1" type="audio/x-wav"><file ref="{}"/></description></speech></bml>'
)


def test_a_recording_that_a_client_names_is_not_played(server, tmp_path: Path):
    path = tmp_path / "secret.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 8000, 0, "NONE", ""))
        file.writeframes(bytes(2 * 8000 * 5))
    with server.client() as client:
        answers = list(client.perform(BLOCK.format("plays", path)))
    (warning,) = (answer for answer in answers if "warningFeedback" in answer)
    assert "is not played: a document that is no file has no folder to find it in" in warning
