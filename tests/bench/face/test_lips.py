"""Lip timing compared with the sound, independent of the voice's own times."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.face.lips import loudness_steps, measure_lips, measure_talk
from kinesic.body.utterance import Script, Sound
from kinesic.face.assets.mesh import load_head
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault

needs_voice = pytest.mark.skipif(bool(espeak_fault()), reason=espeak_fault())


def test_begin_and_end_of_a_speech_sound_are_found_as_loudness_steps():
    noise = np.random.default_rng(3).normal(scale=0.1, size=4000)
    samples = np.concatenate([np.zeros(4000), noise, np.zeros(4000)])
    moments, steps = loudness_steps(Sound.of(16000, samples))
    assert moments[steps.argmax()] == pytest.approx(0.25, abs=0.003)
    assert moments[steps.argmin()] == pytest.approx(0.5, abs=0.003)
    assert moments[0] < 0.0


@pytest.mark.soak
@needs_voice
def test_lips_close_in_time_for_plosives_and_open_at_their_bursts():
    values = measure_lips(("Peter Piper picked a pepper.", "A boat may come tomorrow."))
    for rate in ("slow", "quick"):
        assert values[f"face.lips.{rate}_release_median"] <= 20.0
        assert values[f"face.lips.{rate}_release_p95"] <= 45.0
        assert values[f"face.lips.{rate}_open"] == values[f"face.lips.{rate}_late"] == 0
        assert 100.0 < values[f"face.lips.{rate}_fastest"] <= 300.0


@needs_voice
def test_each_p_b_and_m_closes_the_lips_of_both_heads():
    text = "My mother bought a big brown map."
    utterance = Espeak().say(Script(text))
    for variant in ("female", "male"):
        closings = measure_talk(utterance, load_head(variant)).closings
        assert len(closings) >= 6
        assert all(closing.shut is not None for closing in closings)


@pytest.mark.soak
@needs_voice
def test_lip_benchmark_detects_delayed_sound():
    utterance = Espeak().say(Script("A baby may pipe up."))
    assert utterance.sound is not None
    delay = utterance.sound.rate // 25
    late = Sound.of(utterance.sound.rate, np.concatenate([np.zeros(delay), utterance.sound.samples[:-delay]]))
    head = load_head("female")
    usual, moved = (measure_talk(spoken, head).closings for spoken in (utterance, replace(utterance, sound=late)))
    for before, after in zip(usual, moved, strict=True):
        assert before.open == after.open
        if before.sounds == "p":
            assert after.bursts == pytest.approx(before.bursts + 0.04, abs=0.005)
