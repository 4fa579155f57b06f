import numpy as np
import pytest

from kinesic.body.utterance import Phoneme, Script, Sound, Utterance
from kinesic.speech.espeak import Espeak
from kinesic.speech.recorded.follow import FollowedSpeech, follow_recording, release_stops
from kinesic.speech.recorded.given_times import GivenTime
from kinesic.speech.recorded.rendition import Rendition, render
from tests.speech.recorded.speaking import RECORDED_TEXT, SpokenText, speak

PAUSE_DURATIONS = {0: 0.6, 3: 2.0, 8: 0.8}  # [s] pause before the word of each index


def follow(espeak: Espeak, spoken: SpokenText, given: dict[int, GivenTime] | None = None) -> FollowedSpeech:
    rendition = render(Script(RECORDED_TEXT), espeak)
    times = [(given or {}).get(k, GivenTime()) for k in range(len(rendition.words))]
    followed = follow_recording(rendition, spoken.sound, times)
    assert followed is not None
    return followed


@pytest.mark.parametrize(("pauses", "noise"), [({}, 0.0), (PAUSE_DURATIONS, 0.0), (PAUSE_DURATIONS, 0.1)])
def test_word_starts_are_located_by_sound_despite_pauses_and_noise(
    espeak: Espeak, pauses: dict[int, float], noise: float
):
    spoken = speak(espeak, pauses=pauses, noise=noise)
    errors = np.abs(np.array([start for start, _ in follow(espeak, spoken).words]) - spoken.starts)
    assert np.median(errors) <= 0.05
    assert np.percentile(errors, 95) <= 0.12


def test_word_times_from_a_file_are_kept_and_other_words_lie_between_them(espeak: Espeak):
    spoken = speak(espeak, pauses=PAUSE_DURATIONS)
    given = {k: GivenTime(float(spoken.starts[k]) + 0.007) for k in (1, 4, 9)}
    starts = np.array([start for start, _ in follow(espeak, spoken, given).words])
    for k, time in given.items():
        assert starts[k] == time.start
    assert np.all(np.diff(starts) >= 0.0)
    assert np.median(np.abs(starts - spoken.starts)) <= 0.05


def test_aligned_phonemes_lie_outside_long_silences_of_the_recording(espeak: Espeak):
    spoken = speak(espeak, pauses=PAUSE_DURATIONS, noise=0.05)
    followed = follow(espeak, spoken)
    for word, duration in PAUSE_DURATIONS.items():
        begin, end = spoken.starts[word] - duration + 0.1, spoken.starts[word] - 0.15
        for sound in followed.phonemes:
            onset, release = sound.articulation
            assert release <= begin or onset >= end, sound


def test_lips_close_at_the_times_of_the_bilabials_in_a_recording(espeak: Espeak):
    spoken = speak(espeak)
    expected = [sound.start for sound in spoken.phonemes if sound.letters[:1] in ("p", "b", "m")]
    placed = [sound.start for sound in follow(espeak, spoken).phonemes if sound.letters[:1] in ("p", "b", "m")]
    assert placed == pytest.approx(expected, abs=0.08)


def test_inaudible_final_closure_lasts_until_the_given_end_of_its_word():
    """Hide the closure and burst of a final p by noise."""
    times = np.arange(8000) / 16_000
    rendered = np.concatenate([np.sin(2 * np.pi * 200 * times[:6400]), np.zeros(1600)])
    heard = np.concatenate([np.zeros(8000), rendered, np.zeros(8000)])
    sounds = (Phoneme("k", 0.0, 0.1), Phoneme("ʌ", 0.1, 0.3), Phoneme("p", 0.4, 0.1))
    spoken = Utterance(0.5, {}, sounds, "voice", Sound.of(16_000, rendered))
    rendition = Rendition(spoken, ("cup",), np.array([0.0]), np.array([0.5]), {})
    followed = follow_recording(rendition, Sound.of(16_000, heard), [GivenTime(0.5, 1.0)])
    assert followed is not None
    closure = followed.phonemes[-1]
    assert closure.letters == "p"
    assert closure.end == pytest.approx(1.0, abs=0.02)
    assert closure.start > 0.8


def test_word_with_a_given_time_of_zero_duration_starts_at_that_time(espeak: Espeak):
    spoken = speak(espeak)
    start = float(spoken.starts[4])
    followed = follow(espeak, spoken, {4: GivenTime(start, start)})
    assert followed.words[4][0] == pytest.approx(start)


def test_loud_parts_of_a_recording_open_the_lips_wider(espeak: Espeak):
    spoken = speak(espeak)
    half = len(spoken.sound.samples) // 2
    samples = spoken.sound.samples.copy()
    samples[half:] *= 0.25
    quiet = SpokenText(type(spoken.sound).of(spoken.sound.rate, samples), spoken.starts, spoken.phonemes)
    before, after = (
        np.mean([p.opening for p in follow(espeak, s).phonemes if p.start * spoken.sound.rate > half])
        for s in (spoken, quiet)
    )
    assert after < before - 0.05


def test_lips_open_30_ms_before_the_end_of_a_plosive_with_a_given_time():
    stop, vowel = release_stops((Phoneme("p", 0.0, 0.1), Phoneme("a", 0.1, 0.1)))
    assert stop.articulation == pytest.approx((0.0, 0.07))
    assert vowel.articulation == pytest.approx((0.1, 0.2))
