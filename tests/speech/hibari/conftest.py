"""Fixtures of the neural voice's tests."""

import pytest

from kinesic.speech.engines.engine_voice import EngineVoice
from kinesic.speech.hibari.engine import Hibari, hibari_fault


@pytest.fixture(scope="session")
def neural() -> EngineVoice:
    """Return the neural voice, or skip the test if it is missing."""
    if why := hibari_fault():
        pytest.skip(why)
    return EngineVoice(Hibari())
