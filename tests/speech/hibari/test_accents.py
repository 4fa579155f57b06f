import numpy as np
import pytest

from kinesic.body.utterance import Phoneme
from kinesic.speech.hibari.accents import find_pitch_accents
from kinesic.speech.hibari.model import FRAME_DURATION

STRESSED_VOWEL = Phoneme("\u02c8a", 0.2, 0.2)  # vowel with primary stress from 0.2 to 0.4 s
FRAME_TIMES = (np.arange(80) + 0.5) * FRAME_DURATION  # [s] middle of each pitch frame


def peak(at: float, height: float, base: float = 180.0) -> np.ndarray:
    """Return a pitch curve with one peak of given height and time."""
    return (base * 2.0 ** (height * np.exp(-(((FRAME_TIMES - at) / 0.05) ** 2)) / 12.0)).astype(np.float32)


def test_pitch_peak_on_a_stressed_vowel_is_an_accent():
    assert find_pitch_accents(peak(0.3, 3.0), [STRESSED_VOWEL]) == pytest.approx([0.3], abs=FRAME_DURATION)


@pytest.mark.parametrize(
    ("pitch", "sound"),
    [
        (peak(0.3, 1.0), STRESSED_VOWEL),
        (peak(0.7, 3.0), STRESSED_VOWEL),
        (peak(0.3, 3.0), Phoneme("a", 0.2, 0.2)),
        (peak(0.3, 3.0), Phoneme("\u02c8s", 0.2, 0.2)),
        (np.zeros(80, np.float32), STRESSED_VOWEL),
    ],
    ids=["flat", "elsewhere", "unstressed", "consonant", "voiceless"],
)
def test_flat_pitch_and_peaks_outside_a_stressed_vowel_are_no_accents(pitch: np.ndarray, sound: Phoneme):
    assert find_pitch_accents(pitch, [sound]) == ()


def test_higher_of_two_pitch_peaks_on_a_vowel_is_its_accent():
    curve = np.maximum(peak(0.22, 2.0), peak(0.36, 4.0))
    assert find_pitch_accents(curve, [STRESSED_VOWEL]) == pytest.approx([0.36], abs=FRAME_DURATION)


def test_pitch_accent_is_found_despite_unvoiced_frames_within_its_peak():
    curve = peak(0.3, 3.0)
    curve[28:34] = 0.0
    assert find_pitch_accents(curve, [STRESSED_VOWEL]) == pytest.approx([0.3], abs=FRAME_DURATION)
