"""Lips beside the sound: what is measured does not take the voice's own times for those of the sound."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.face.lips import loudness_steps, measure_lips, talk
from kinesic.body.utterance import Script, Sound
from kinesic.face.assets.mesh import load_head
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault

needs_voice = pytest.mark.skipif(bool(espeak_fault()), reason=espeak_fault())


def test_a_step_is_found_where_sound_begins_and_where_it_ends():
    noise = np.random.default_rng(3).normal(scale=0.1, size=4000)
    samples = np.concatenate([np.zeros(4000), noise, np.zeros(4000)])
    moments, steps = loudness_steps(Sound.of(16000, samples))
    assert moments[steps.argmax()] == pytest.approx(0.25, abs=0.003)
    assert moments[steps.argmin()] == pytest.approx(0.5, abs=0.003)
    assert moments[0] < 0.0


@needs_voice
def test_lips_close_in_time_open_at_the_burst_and_are_no_faster_than_lips():
    found = measure_lips(("Peter Piper picked a pepper.", "A boat may come tomorrow."))
    for rate in ("slow", "quick"):
        assert found[f"face.lips.{rate}_release_median"] <= 20.0
        assert found[f"face.lips.{rate}_release_p95"] <= 45.0
        assert found[f"face.lips.{rate}_open"] == found[f"face.lips.{rate}_late"] == 0
        assert 100.0 < found[f"face.lips.{rate}_fastest"] <= 300.0


@needs_voice
def test_every_p_b_and_m_closes_the_lips_of_both_heads():
    text = "My mother bought a big brown map. Happy people pump up a bumper, maybe."
    said = Espeak().say(Script(text))
    for variant in ("female", "male"):
        closings = talk(said, load_head(variant)).closings
        assert len(closings) >= 16
        assert all(closing.shut is not None for closing in closings)


@needs_voice
def test_a_voice_that_is_late_is_found_out():
    said = Espeak().say(Script("A baby may pipe up."))
    assert said.sound is not None
    delay = said.sound.rate // 25
    late = Sound.of(said.sound.rate, np.concatenate([np.zeros(delay), said.sound.samples[:-delay]]))
    head = load_head("female")
    usual, moved = (talk(each, head).closings for each in (said, replace(said, sound=late)))
    for before, after in zip(usual, moved, strict=True):
        assert before.open == after.open
        if before.sounds == "p":
            assert after.bursts == pytest.approx(before.bursts + 0.04, abs=0.005)
