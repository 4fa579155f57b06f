"""Voice detector by NumPy."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from kinesic.hearing.voice_activity import CONTEXT_SIZE, FRAME_SIZE, VOICE_RATE, VoiceDetector

PUBLISHED_MODEL = "silero_vad_16k_op15.onnx"  # file of the package silero-vad
MAX_DIFFERENCE = 5e-6  # largest difference of probabilities between two implementations
# Probabilities of the published model for `buzz`, by onnxruntime 1.32.
PUBLISHED_PROBABILITIES = (
    0.141833,
    0.079127,
    0.037692,
    0.027074,
    0.019666,
    0.014111,
    0.153077,
    0.847893,
    0.902274,
    0.873731,
    0.802377,
    0.702638,
    0.899678,
    0.782704,
    0.840653,
    0.767565,
    0.561581,
    0.406014,
    0.500218,
    0.214015,
    0.113840,
    0.092349,
    0.048615,
    0.140261,
    0.090142,
    0.088363,
    0.070110,
    0.075478,
    0.064609,
    0.048625,
    0.040589,
    0.039979,
    0.037179,
    0.069157,
    0.076631,
    0.064053,
    0.067761,
    0.058503,
    0.043090,
    0.032299,
)


def buzz(frames: int) -> np.ndarray:
    """Return seeded noise with a synthetic voice in its middle.

    The voice has a gliding pitch and two formants.
    """
    time = np.arange(frames * FRAME_SIZE) / VOICE_RATE
    pitch = 2 * np.pi * np.cumsum(120 + 25 * np.sin(9 * time)) / VOICE_RATE
    voice = sum(
        np.sin(k * pitch) * (np.exp(-(((k * 120 - 600) / 250) ** 2)) + np.exp(-(((k * 120 - 1500) / 300) ** 2)) + 0.02)
        for k in range(1, 30)
    )
    loudness = np.clip(np.sin(np.pi * time / time[-1]) * 2 - 0.9, 0, 1) * (0.6 + 0.4 * np.sin(25 * time))
    noise = np.random.default_rng(3).normal(0.0, 0.002, len(time))
    return (0.1 * loudness * voice + noise).astype(np.float32)


def probabilities(sound: np.ndarray) -> list[float]:
    detector = VoiceDetector()
    return [detector.probability(sound[k : k + FRAME_SIZE]) for k in range(0, len(sound), FRAME_SIZE)]


def test_voice_probabilities_equal_stored_values_of_the_published_model():
    np.testing.assert_allclose(probabilities(buzz(40)), PUBLISHED_PROBABILITIES, atol=MAX_DIFFERENCE)


def test_voice_probabilities_equal_those_of_onnxruntime():
    runtime = pytest.importorskip("onnxruntime", reason="onnxruntime is not installed")
    package = importlib.util.find_spec("silero_vad")
    if package is None or package.origin is None:
        pytest.skip("silero-vad, which holds the published model, is not installed")
    session = runtime.InferenceSession(str(Path(package.origin).parent / "data" / PUBLISHED_MODEL))
    sound, state, context = buzz(40), np.zeros((2, 1, 128), np.float32), np.zeros(CONTEXT_SIZE, np.float32)
    expected = []
    for k in range(0, len(sound), FRAME_SIZE):
        frame = np.concatenate([context, sound[k : k + FRAME_SIZE]])
        context = frame[-CONTEXT_SIZE:]
        result, state = session.run(None, {"input": frame[None], "state": state, "sr": np.array(VOICE_RATE)})
        expected.append(float(result[0, 0]))
    np.testing.assert_allclose(probabilities(sound), expected, atol=MAX_DIFFERENCE)


def test_silence_and_a_steady_tone_do_not_count_as_voice():
    time = np.arange(30 * FRAME_SIZE) / VOICE_RATE
    for sound in (np.zeros(len(time), np.float32), (0.2 * np.sin(2 * np.pi * 1000 * time)).astype(np.float32)):
        assert max(probabilities(sound)[3:]) < 0.5


def test_reset_voice_detector_gives_the_same_probabilities_as_a_new_one():
    sound, detector = buzz(30), VoiceDetector()
    for k in range(0, len(sound), FRAME_SIZE):
        detector.probability(sound[k : k + FRAME_SIZE])
    detector.reset()
    assert detector.probability(sound[:FRAME_SIZE]) == probabilities(sound[:FRAME_SIZE])[0]
