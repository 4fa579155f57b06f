"""Tests of the pronunciation lexicon, loaded once for all forked processes."""

from importlib import reload

import pytest

from kinesic.speech.engines.phrase import EngineError
from kinesic.speech.hibari import pronunciation, read_ahead
from kinesic.speech.voice import HIBARI_TABLES_MODULE


def test_import_of_read_ahead_loads_the_pronunciation_lexicon(monkeypatch: pytest.MonkeyPatch):
    reads = []
    monkeypatch.setattr(pronunciation, "load_reader", lambda: reads.append(True))
    assert reload(read_ahead).__name__ == HIBARI_TABLES_MODULE
    assert reads == [True]


def test_import_of_read_ahead_without_the_voice_package_succeeds_after_one_attempt(monkeypatch: pytest.MonkeyPatch):
    attempts = []

    def fail() -> None:
        attempts.append(True)
        raise EngineError("not installed")

    monkeypatch.setattr(pronunciation, "load_reader", fail)
    assert reload(read_ahead) is read_ahead
    assert attempts == [True]
