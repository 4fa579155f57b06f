"""Cancellation of the robot's own voice."""

import numpy as np
import pytest

from kinesic.hearing.echo import EchoCanceller
from kinesic.hearing.own_voice import OwnVoiceGate
from kinesic.hearing.voice_activity import FRAME_SIZE, VOICE_RATE

DELAY = 900  # [samples] delay of the echo: 56 ms


def modulated_noise(seed: int, duration: float) -> np.ndarray:
    """Return noise with a syllable-like loudness, instead of a voice."""
    count = round(duration * VOICE_RATE / FRAME_SIZE) * FRAME_SIZE
    loudness = 0.05 * np.clip(np.sin(np.arange(count) * 2 * np.pi * 4 / VOICE_RATE) + 0.4, 0.0, None)
    return (loudness * np.random.default_rng(seed).normal(size=count)).astype(np.float32)


def room_echo(played: np.ndarray, seed: int = 1, *, delay: int = DELAY) -> np.ndarray:
    """Return the echo of a sound, delayed by a number of samples.

    The echo has 60 ms of reverberation.
    """
    tail = 960
    path = np.random.default_rng(seed).normal(size=tail) * np.exp(-np.arange(tail) / 200) * 0.1
    path[0] = 0.8
    return np.convolve(played, np.concatenate([np.zeros(delay), path]))[: len(played)].astype(np.float32)


def run(heard, played):
    """Return the cleaned sound, the echo and the gate's flags."""
    canceller, gate = EchoCanceller(), OwnVoiceGate()
    parts = []
    for k in range(0, len(heard), FRAME_SIZE):
        cleaned, echo = canceller.cancel(heard[k : k + FRAME_SIZE], played[k : k + FRAME_SIZE])
        parts.append((cleaned, echo, gate.admits(cleaned, echo)))
    cleaned, echoes, flags = zip(*parts, strict=True)
    return np.concatenate(cleaned), np.concatenate(echoes), np.array(flags)


def level(sound):
    return 10 * np.log10(np.mean(np.square(sound)) + 1e-12)


def test_echo_of_the_played_sound_is_cancelled_within_a_second():
    played = modulated_noise(2, 4.0)
    heard = room_echo(played)
    cleaned, *_ = run(heard, played)
    late = slice(2 * VOICE_RATE, None)
    assert level(heard[late]) - level(cleaned[late]) > 20.0


@pytest.mark.parametrize(("delay", "is_cancelled"), [(0, True), (FRAME_SIZE, True), (2400, True), (4096, False)])
def test_only_an_echo_of_the_same_frame_or_up_to_a_quarter_second_later_is_cancelled(delay, is_cancelled):
    played = modulated_noise(2, 4.0)
    heard = room_echo(played, delay=delay)
    cleaned, *_ = run(heard, played)
    late = slice(2 * VOICE_RATE, None)
    assert (level(heard[late]) - level(cleaned[late]) > 15.0) == is_cancelled


def test_echo_cancellation_keeps_the_voice_of_a_person():
    played, person = modulated_noise(2, 4.0), modulated_noise(3, 4.0)
    person[: 3 * VOICE_RATE] = 0.0
    cleaned, *_ = run(room_echo(played) + person, played)
    late = slice(3 * VOICE_RATE, None)
    assert level(cleaned[late] - person[late]) < level(person[late]) - 10.0


def test_echo_cancellation_with_a_silent_loudspeaker_keeps_the_sound_unchanged():
    heard = modulated_noise(4, 1.0)
    cleaned, echo, flags = run(heard, np.zeros_like(heard))
    np.testing.assert_array_equal(cleaned, heard)
    assert not echo.any()
    assert flags.sum() > 0.5 * len(flags)


def test_echo_gate_passes_the_voice_of_a_person_and_blocks_residual_echo():
    played, person = modulated_noise(2, 6.0), modulated_noise(5, 6.0)
    person[: 4 * VOICE_RATE] = 0.0
    clipped = np.clip(3 * played, -0.2, 0.2) / 3  # a loudspeaker that distorts leaves an echo
    _, _, flags = run(room_echo(clipped) + person, played)
    start, voice = VOICE_RATE // FRAME_SIZE, 4 * VOICE_RATE // FRAME_SIZE
    assert flags[start:voice].mean() < 0.1
    loud = np.abs(person.reshape(-1, FRAME_SIZE)).mean(axis=1) > 0.02
    assert flags[loud].mean() > 0.8


def test_echo_canceller_learns_a_changed_echo_path_within_four_seconds():
    played = modulated_noise(2, 8.0)
    half = len(played) // 2 // FRAME_SIZE * FRAME_SIZE
    heard = np.concatenate([room_echo(played)[:half], room_echo(played, seed=9)[half:]])
    cleaned, *_ = run(heard, played)
    assert level(heard[-VOICE_RATE:]) - level(cleaned[-VOICE_RATE:]) > 8.0


class WrittenOutFilter:
    """Kalman filter of the echo path, one partition of 512 samples after the other."""

    def __init__(self) -> None:
        self.played = [np.zeros(513, complex)] * 8
        self.path, self.variance = np.zeros((8, 513), complex), np.ones((8, 513))
        self.noise, self.last = np.zeros(513), np.zeros(512)

    def echo(self) -> np.ndarray:
        return np.fft.irfft(sum(self.path[k] * self.played[k] for k in range(8)))[512:]

    def cancel(self, heard: np.ndarray, played: np.ndarray) -> np.ndarray:
        self.played = [np.fft.rfft(np.concatenate([self.last, played])), *self.played[:7]]
        self.last = played
        error = np.fft.rfft(np.concatenate([np.zeros(512), heard - self.echo()]))
        self.noise = 0.7 * self.noise + 0.3 * np.abs(error) ** 2
        spread = sum(0.5 * np.abs(self.played[k]) ** 2 * self.variance[k] for k in range(8)) + self.noise + 1e-9
        for k in range(8):
            gain = 0.5 * self.variance[k] / spread
            change = np.fft.irfft(gain * np.conj(self.played[k]) * error)[:512]
            self.path[k] = 0.998 * (self.path[k] + np.fft.rfft(change, 1024))
            kept = (1.0 - 0.5 * gain * np.abs(self.played[k]) ** 2) * self.variance[k]
            self.variance[k] = 0.998**2 * kept + (1.0 - 0.998**2) * np.abs(self.path[k]) ** 2
        return heard - self.echo()


def test_echo_canceller_equals_a_written_out_kalman_filter():
    played = modulated_noise(6, 1.5).astype(np.float64)
    heard = room_echo(played) + 0.001 * np.random.default_rng(7).normal(size=len(played))
    canceller, reference = EchoCanceller(), WrittenOutFilter()
    for k in range(0, len(played), FRAME_SIZE):
        rows = slice(k, k + FRAME_SIZE)
        cleaned, _ = canceller.cancel(heard[rows], played[rows])
        np.testing.assert_allclose(cleaned, reference.cancel(heard[rows], played[rows]), atol=1e-6)
