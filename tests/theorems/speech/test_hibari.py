"""Properties of every script spoken by the neural voice."""

import numpy as np
import pytest
from hypothesis import given

from kinesic.body.utterance import Mark, Script
from kinesic.speech.engines.engine_voice import EngineVoice
from kinesic.speech.hibari.engine import Hibari, hibari_fault

from .test_espeak import FEW_EXAMPLES, scripts


@pytest.fixture(scope="module", autouse=True)
def _engine():
    if why := hibari_fault():
        pytest.skip(why)


@FEW_EXAMPLES
@given(scripts())
def test_neural_voice_marks_phonemes_and_accents_are_ordered_and_within_the_speech(script: Script):
    said = EngineVoice(Hibari()).say(script)
    times = [said.marks[stop.name] for stop in script.stops() if isinstance(stop, Mark)]
    assert times == sorted(times)
    assert all(0.0 <= time <= said.duration + 1e-9 for time in times)
    ends = [0.0, *(phoneme.end for phoneme in said.phonemes)]
    assert all(phoneme.duration >= 0.0 for phoneme in said.phonemes)
    assert all(phoneme.start >= end - 1e-9 for phoneme, end in zip(said.phonemes, ends, strict=False))
    assert ends[-1] <= said.duration + 1e-9
    assert list(said.accents) == sorted(said.accents)
    if said.sound is None:
        assert any(remark.startswith("no sound: ") for remark in said.remarks)
    else:
        assert said.sound.duration == pytest.approx(said.duration)
        assert np.abs(said.sound.samples).max(initial=0.0) <= 1.0
