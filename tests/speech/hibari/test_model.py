"""Tests of the check whether the voice's model is installed."""

import subprocess
import sys
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.speech.hibari import model
from kinesic.speech.voice import voice

# program that creates the voice and prints whether its model is loaded
CREATE_SCRIPT = """
import sys
from kinesic.speech.voice import voice
voice("hibari")
print([name for name in ("onnxruntime", "hibari") if name in sys.modules])
"""


@pytest.fixture
def unchecked():
    """Clear the cached results of installation checks around a test."""
    model.find_installation_fault.cache_clear()
    yield
    model.find_installation_fault.cache_clear()


def test_requested_voice_is_created_without_loading_its_model():
    """Check that the server's main process need not load the model."""
    if why := model.find_installation_fault():
        pytest.skip(why)
    created = subprocess.run(
        [sys.executable, "-c", CREATE_SCRIPT], capture_output=True, text=True, check=True, timeout=60
    )
    assert created.stdout.strip() == "[]"


@pytest.mark.usefixtures("unchecked")
def test_missing_voice_package_raises_an_error_that_names_the_extra_that_installs_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(model, "find_package", lambda: None)
    with pytest.raises(ConfigError, match=r"hibari-tts is not installed: .*voice"):
        voice("hibari")


@pytest.mark.usefixtures("unchecked")
def test_missing_model_file_of_the_neural_voice_is_named_in_the_error(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "hibari.onnx").touch()
    monkeypatch.setattr(model, "find_package", lambda: tmp_path)
    with pytest.raises(ConfigError, match=r"assets has no vocab\.json"):
        voice("hibari")
