"""Loudness of streamed speech, and its stressed syllables.

The loudest peaks of the envelope from 300 to 2500 Hz, at least 0.6 s apart, are stressed syllables.
"""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.utterance import Samples

LOUDNESS_RATE = 100  # [Hz] rate of the levels
SPEECH_BAND = (300.0, 2500.0)  # [Hz] frequencies whose level is measured
WINDOW_DURATION = 0.02  # [s] duration of one measurement
MIN_LEVEL = 0.005  # level of the softest speech, for samples in -1..1
PEAK_REACH = 0.3  # [s] time before and after a peak in which no level is higher
MIN_PEAK_RATIO = 0.35  # smallest level of a peak / highest level so far


class LoudnessMeter:
    """Streaming measurement of the level in the band of speech."""

    def __init__(self, rate: int) -> None:
        """Create a meter for samples of a rate [Hz] that `LOUDNESS_RATE` divides."""
        self._step, self._window = rate // LOUDNESS_RATE, round(WINDOW_DURATION * rate)
        frequencies = np.fft.rfftfreq(self._window, 1.0 / rate)
        self._band = (frequencies >= SPEECH_BAND[0]) & (frequencies <= SPEECH_BAND[1])
        self._shape = np.hanning(self._window)
        self._kept: Samples = np.zeros(self._window // 2, np.float32)  # samples that later windows need
        self.levels: Floats = np.zeros(0)  # (m,) level at 100 Hz, centred on its time

    def feed(self, samples: Samples) -> None:
        """Measure the next samples (k,) in -1..1."""
        sound = np.concatenate([self._kept, samples])
        count = max(0, (len(sound) - self._window) // self._step + 1)
        starts = self._step * np.arange(count)
        windows = sound[starts[:, None] + np.arange(self._window)] * self._shape
        power = np.abs(np.fft.rfft(windows)[:, self._band]) ** 2
        self._kept = sound[count * self._step :]
        self.levels = np.concatenate([self.levels, np.sqrt(power.sum(axis=1)) / self._shape.sum()])


def find_stressed_syllables(levels: Floats, first: int) -> list[int]:
    """Return the indices of stressed syllables in levels (m,) after an index.

    A syllable whose surroundings are incomplete is not returned.
    """
    reach = round(PEAK_REACH * LOUDNESS_RATE)
    highest = max(MIN_LEVEL, float(levels.max(initial=0.0)))
    return [
        index
        for index in range(max(first, 0), len(levels) - reach)
        if levels[index] >= MIN_PEAK_RATIO * highest
        and index - reach + int(np.argmax(levels[max(0, index - reach) : index + reach + 1])) + max(0, reach - index)
        == index
    ]
