from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.utterance import STRESS_MARKS, Sound
from kinesic.speech.espeak import Espeak
from kinesic.speech.recorded.unworded import FRAME_PERIOD, SOUND_SYMBOLS, _classify, _join, _max_near, lip_sounds
from tests.speech.recorded.speaking import speak

RATE = 16_000


def voice_like(parts: list[tuple[float, float, float]]) -> Sound:
    """Return buzzing parts of (duration [s], amplitude, formant [Hz]); amplitude 0 is silence."""
    pieces = [np.zeros(RATE // 2)]
    for duration, amplitude, formant in parts:
        times = np.arange(round(duration * RATE)) / RATE
        harmonics = [(k * 120.0, np.exp(-(((k * 120.0 - formant) / 300.0) ** 2)) + 0.02) for k in range(1, 40)]
        piece = sum(weight * np.sin(2 * np.pi * frequency * times) for frequency, weight in harmonics)
        pieces.append(amplitude * piece / 6.0)
    return Sound.of(RATE, np.concatenate([*pieces, np.zeros(RATE // 2)]))


def letters(sound: Sound) -> list[str]:
    return [phoneme.letters for phoneme in lip_sounds(sound) if phoneme.duration >= 0.1]


def test_high_first_formant_opens_the_mouth_and_a_low_one_rounds_the_lips():
    assert letters(voice_like([(0.5, 0.5, 800.0)])) == ["a"]
    assert letters(voice_like([(0.5, 0.5, 250.0)])) == ["u"]


def test_noise_of_high_frequency_hisses():
    noise = np.diff(np.random.default_rng(1).normal(0.0, 0.2, RATE // 2), n=3)
    sound = Sound.of(RATE, np.concatenate([np.zeros(RATE // 2), 0.2 * noise, np.zeros(RATE // 2)]))
    assert set(letters(sound)) == {"s"}


def test_lips_rest_in_silences_and_sounds_touch_within_speech():
    sounds = lip_sounds(voice_like([(0.5, 0.5, 700.0), (1.0, 0.0, 500.0), (0.5, 0.5, 700.0)]))
    gaps = [b.start - a.end for a, b in pairwise(sounds) if b.start - a.end > 0.001]
    assert gaps == pytest.approx([1.0], abs=0.05)
    assert sounds[0].start == pytest.approx(0.5, abs=0.03)


def test_louder_syllable_has_the_accent_and_a_wider_mouth():
    parts = [(0.2, 0.2, 700.0), (0.05, 0.01, 700.0)] * 3 + [(0.2, 0.8, 700.0), (0.05, 0.01, 700.0)]
    parts += [(0.2, 0.2, 700.0), (0.05, 0.01, 700.0)] * 3
    accented = [sound for sound in lip_sounds(voice_like(parts)) if sound.symbol.startswith(STRESS_MARKS[0])]
    assert len(accented) == 1
    assert 1.2 < accented[0].start + accented[0].duration / 2 < 1.5
    assert accented[0].opening > 1.1


def test_silent_recording_has_no_sounds():
    assert lip_sounds(Sound.of(RATE, np.zeros(RATE))) == ()


def test_speech_has_syllables_and_accents_but_not_on_each(espeak: Espeak):
    sounds = lip_sounds(speak(espeak).sound)
    accents = [sound for sound in sounds if sound.symbol.startswith(STRESS_MARKS[0])]
    vowels = [sound for sound in sounds if sound.symbol.startswith(STRESS_MARKS)]
    assert 2 <= len(accents) <= len(vowels) / 2


def test_pitch_near_a_frame_is_the_median_of_the_voiced_frames_around_it():
    semitones = np.arange(40.0)
    assert _max_near(semitones, 20) == 20.0
    assert _max_near(semitones, 2) == 3.5  # frames 0 to 7
    semitones[16:25] = np.nan
    assert _max_near(semitones, 20) == 20.0
    assert np.isnan(_max_near(np.full(40, np.nan), 20))


def test_each_sound_lasts_at_least_four_frames():
    symbols = np.array([2] * 10 + [3] * 3 + [2] * 7 + [5] * 4 + [3] * 6)
    frames = len(symbols)
    sounds = _join(symbols, np.ones(frames), np.ones(frames, dtype=bool))
    assert [(sound.symbol, round(sound.start / FRAME_PERIOD)) for sound in sounds] == [
        ("e", 0),
        ("a", 10),
        ("e", 14),
        ("m", 20),
        ("a", 24),
    ]


def test_lips_close_around_a_dip_of_loudness_within_speech():
    levels = -np.maximum(0.0, 30.0 - 4.0 * np.abs(np.arange(60) - 30))
    is_speech = np.ones(60, dtype=bool)
    closed = SOUND_SYMBOLS.index("m")
    kinds = _classify(np.ones((60, 26)), levels, is_speech)
    assert np.flatnonzero(kinds == closed).tolist() == [28, 29, 30, 31, 32]
    assert closed not in _classify(np.ones((60, 26)), 0.3 * levels, is_speech)
    assert closed not in _classify(np.ones((60, 26)), levels, ~is_speech)
