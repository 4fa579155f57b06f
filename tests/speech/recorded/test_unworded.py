from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.utterance import STRESS_MARKS, Phoneme, Sound
from kinesic.speech.espeak import Espeak
from kinesic.speech.recorded.unworded import (
    FRAME_PERIOD,
    SOUND_SYMBOLS,
    _classify,
    _find_accents,
    _join,
    _max_near,
    _stress,
    lip_sounds,
)
from tests.speech.recorded.speaking import speak

SAMPLE_RATE = 16_000  # [Hz]


def voice_like(parts: list[tuple[float, float, float]]) -> Sound:
    """Return voice-like sounds of given durations [s], amplitudes and formants [Hz]."""
    pieces = [np.zeros(SAMPLE_RATE // 2)]
    for duration, amplitude, formant in parts:
        times = np.arange(round(duration * SAMPLE_RATE)) / SAMPLE_RATE
        harmonics = [(k * 120.0, np.exp(-(((k * 120.0 - formant) / 300.0) ** 2)) + 0.02) for k in range(1, 40)]
        piece = sum(weight * np.sin(2 * np.pi * frequency * times) for frequency, weight in harmonics)
        pieces.append(amplitude * piece / 6.0)
    return Sound.of(SAMPLE_RATE, np.concatenate([*pieces, np.zeros(SAMPLE_RATE // 2)]))


def letters(sound: Sound) -> list[str]:
    return [phoneme.letters for phoneme in lip_sounds(sound) if phoneme.duration >= 0.1]


def test_high_first_formant_opens_the_mouth_and_a_low_one_rounds_the_lips():
    assert letters(voice_like([(0.5, 0.5, 800.0)])) == ["a"]
    assert letters(voice_like([(0.5, 0.5, 250.0)])) == ["u"]


def test_high_frequency_noise_is_classified_as_the_sound_s():
    noise = np.diff(np.random.default_rng(1).normal(0.0, 0.2, SAMPLE_RATE // 2), n=3)
    sound = Sound.of(SAMPLE_RATE, np.concatenate([np.zeros(SAMPLE_RATE // 2), 0.2 * noise, np.zeros(SAMPLE_RATE // 2)]))
    assert set(letters(sound)) == {"s"}


def test_lip_sounds_are_contiguous_within_speech_and_absent_in_silences():
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


def test_silent_recording_has_no_lip_sounds():
    assert lip_sounds(Sound.of(SAMPLE_RATE, np.zeros(SAMPLE_RATE))) == ()


def test_at_least_two_but_at_most_half_of_the_vowels_of_speech_are_accented(espeak: Espeak):
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


def test_lip_sounds_last_at_least_four_frames():
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


@pytest.mark.parametrize(
    ("low", "middle", "high", "hiss", "symbol"),
    [
        (1.0, 0.61, 0.59, 0.0, "\u0259"),
        (1.0, 0.59, 0.59, 0.0, "u"),
        (1.0, 0.61, 0.61, 0.0, "e"),
        (1.0, 0.59, 0.61, 0.0, "e"),
        (1.0, 1.79, 0.5, 0.0, "\u0259"),
        (1.0, 1.81, 0.7, 0.0, "a"),
        (1.0, 1.81, 0.7, 3.5, "a"),
        (1.0, 1.81, 0.7, 3.52, "s"),
    ],
)
def test_lip_sound_is_chosen_by_the_power_of_low_middle_high_and_hissing_bands(low, middle, high, hiss, symbol):
    powers = np.concatenate(
        [np.full(count, power / count) for count, power in ((5, low), (7, middle), (7, high), (7, hiss))]
    )
    kinds = _classify(np.tile(powers, (9, 1)), np.zeros(9), np.ones(9, dtype=bool))
    assert [SOUND_SYMBOLS[kind] for kind in kinds] == [symbol] * 9


def test_lip_sounds_have_the_mean_opening_of_their_frames_and_are_absent_in_silence():
    symbols, openings = np.array([0] * 6 + [1] * 4 + [1] * 3 + [5] * 2), np.arange(15) / 7
    is_speech = np.array([True] * 10 + [False] * 3 + [True] * 2)
    assert list(_join(symbols, openings, is_speech)) == [
        Phoneme("\u0259", 0.0, pytest.approx(0.06), opening=0.357),
        Phoneme("u", pytest.approx(0.06), pytest.approx(0.04), opening=1.071),
        Phoneme("m", pytest.approx(0.13), pytest.approx(0.02), opening=1.929),
    ]


def test_vowel_has_primary_stress_if_an_accent_falls_into_it():
    sounds = [Phoneme(symbol, 0.125 * k, 0.125) for k, symbol in enumerate(("\u0259", "u", "m", "e", "a", "s"))]
    stressed = _stress(sounds, np.array([0.125, 0.3, 0.5, 0.7]))
    assert [sound.symbol for sound in stressed] == ["\u02cc\u0259", "\u02c8u", "m", "\u02cce", "\u02c8a", "s"]


def syllables(heights: dict[int, float], count: int = 800) -> np.ndarray:
    """Return levels [dB] with a triangular peak per syllable height."""
    levels = np.full(count, -30.0)
    for frame, height in heights.items():
        rise = height - 1.0 * np.abs(np.arange(count) - frame)
        levels = np.maximum(levels, -30.0 + rise)
    return levels


def accents(levels: np.ndarray, pitch: dict[int, float] | None = None, silent: slice = slice(0)) -> list[int]:
    hertz = np.full(len(levels), np.nan)
    for frame, value in (pitch or {}).items():
        hertz[frame - 3 : frame + 4] = value
    is_speech = np.ones(len(levels), dtype=bool)
    is_speech[silent] = False
    return _find_accents(levels, hertz, is_speech).tolist()


def test_syllable_has_an_accent_if_it_is_louder_than_all_syllables_within_two_seconds():
    assert accents(syllables({100: 10.0, 200: 10.0, 300: 15.2, 400: 10.0})) == [300]
    assert accents(syllables({100: 10.0, 200: 10.0, 300: 14.2, 400: 10.0})) == []
    assert accents(syllables({100: 10.0, 300: 15.2, 500: 10.0})) == [300]
    assert accents(syllables({99: 10.0, 300: 15.2, 501: 10.0})) == []
    assert accents(syllables({100: 10.0, 300: 18.0}), silent=slice(300, 301)) == []


def test_syllable_of_higher_pitch_has_an_accent_unless_it_is_voiceless():
    even = syllables({100: 10.0, 200: 10.0, 300: 10.0})
    assert accents(even, {100: 100.0, 200: 100.0, 300: 100.0 * 2 ** (3.1 / 12)}) == [300]
    assert accents(even, {100: 100.0, 200: 100.0, 300: 100.0 * 2 ** (2.9 / 12)}) == []
    assert accents(even, {100: 100.0 * 2 ** (-8 / 12), 200: 100.0}) == [200]
    assert accents(even) == []


@pytest.mark.parametrize(("distance", "count"), [(40, 2), (39, 1)])
def test_two_accents_are_at_least_forty_frames_apart(distance, count):
    levels = syllables({100: 9.0, 150: 9.0, 200: 9.0, 250: 17.0, 250 + distance: 16.0, 340: 9.0, 390: 9.0})
    found = accents(levels)
    assert found == [250, 250 + distance][:count]
