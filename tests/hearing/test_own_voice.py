"""Power above which a frame counts as a sound other than the robot's voice."""

import numpy as np
import pytest

from kinesic.hearing.own_voice import OwnVoiceGate
from kinesic.hearing.voice_activity import FRAME_SIZE, VOICE_RATE

TIMES = np.arange(FRAME_SIZE) / VOICE_RATE
FREQUENCIES = np.fft.rfftfreq(2 * FRAME_SIZE, 1.0 / VOICE_RATE)
VOICE_BAND = (FREQUENCIES > 300.0) & (FREQUENCIES < 4000.0)
TONE = np.sin(2 * np.pi * 1000.0 * TIMES)


def band_power(frame: np.ndarray) -> float:
    return float(np.mean(np.abs(np.fft.rfft(frame, 2 * FRAME_SIZE)[VOICE_BAND]) ** 2))


def tone_of(power: float) -> np.ndarray:
    """Return a tone in the voice band with a given mean power."""
    return TONE * np.sqrt(power / band_power(TONE))


def admits(history: list[tuple[float, float]], frame: float, echo: float, unit: float) -> bool:
    """Return the gate's answer to a frame after others, for pairs of powers (frame, echo) in a unit."""
    gate = OwnVoiceGate()
    for before, echo_before in history:
        gate.admits(tone_of(before * unit), tone_of(echo_before * unit))
    return gate.admits(tone_of(frame * unit), tone_of(echo * unit))


@pytest.mark.parametrize(
    ("history", "echo", "threshold", "unit"),
    [
        ([(1.0, 0.0)], 0.0, 4 * 0.3 * 1.01, 1.0),
        ([(1.0, 0.0), (0.5, 0.0)], 0.0, 4 * 0.3 * 0.505, 1.0),
        ([(0.0, 0.0)], 0.0, 4 * 0.3 * 1.01, 1e-9),
        ([(0.1, 1.0)], 1.0, 4 * (0.42 + 0.3 * 0.101), 1.0),
        ([(0.8, 1.0)], 1.0, 4 * (0.505 + 0.3 * 0.808), 1.0),
        ([(2.0, 1.0)] * 100, 1.0, 4 * (1.0 + 0.3 * 2.02), 1.0),
        ([(0.5, 1.0)], 0.0, 4 * (0.505 * 0.7 + 0.3 * 0.505), 1.0),
        ([(0.1, 1.0)], 1.0, 4 * (0.5 + 0.3 * 0.101), 0.9e-5),
        ([(0.1, 1.0)], 1.0, 4 * (0.42 + 0.3 * 0.101), 1.1e-5),
        ([(0.5, 1.0), (0.01, 0.06)], 0.06, 4 * (0.505 * 0.49 + 0.3 * 0.0101), 1.0),
        ([(0.5, 1.0), (0.01, 0.08)], 0.08, 4 * ((0.505 + 0.2 * (0.01 / 0.7 - 0.505)) * 0.49 + 0.3 * 0.0101), 1.0),
    ],
)
def test_voice_must_be_four_times_as_powerful_as_the_expected_residual_echo_and_noise(history, echo, threshold, unit):
    assert not admits(history, 0.999 * threshold, echo, unit)
    assert admits(history, 1.001 * threshold, echo, unit)


@pytest.mark.parametrize(("frequency", "is_heard"), [(200.0, False), (400.0, True), (3800.0, True), (4300.0, False)])
def test_only_sounds_from_300_to_4000_hz_count_as_a_voice(frequency, is_heard):
    gate, silence = OwnVoiceGate(), np.zeros(FRAME_SIZE)
    gate.admits(0.02 * TONE, silence)
    smooth = np.hanning(FRAME_SIZE)  # a tone that begins suddenly has power in all bands
    assert gate.admits(smooth * 0.1 * np.sin(2 * np.pi * frequency * TIMES), silence) == is_heard
