"""Conversion of streamed sound to the rate of the voice detector."""

from math import gcd

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from kinesic.body.utterance import Samples

FILTER_REACH = 10  # zero crossings of the filter before and after its peak
FILTER_SHAPE = 5.0  # beta of the Kaiser window, for a stopband attenuation of 54 dB
MAX_INPUT_RATE = 192_000  # [Hz] highest rate of a sound card
MIN_INPUT_RATE = 4_000  # [Hz] lowest accepted sample rate; at lower rates, speech is not intelligible


class StreamResampler:
    """Streaming conversion between two sample rates by a windowed low-pass filter."""

    def __init__(self, rate: int, new_rate: int) -> None:
        """Create a converter at the start of a stream.

        Args:
            rate: rate of the stream [Hz].
            new_rate: rate of the result [Hz].

        Raises:
            ValueError: the rate is outside the range of microphones.
        """
        if not MIN_INPUT_RATE <= rate <= MAX_INPUT_RATE:
            raise ValueError(f"rate {rate} Hz: it must be from {MIN_INPUT_RATE} to {MAX_INPUT_RATE} Hz")
        common = gcd(rate, new_rate)
        self._up, self._down = new_rate // common, rate // common
        slower = max(self._up, self._down)
        self._side = -(-FILTER_REACH * slower // self._up) + 1  # samples before and after each result
        steps = np.arange(-self._side, self._side + 1)[None, :] * self._up - np.arange(self._up)[:, None]
        window = np.kaiser(2 * FILTER_REACH * slower + 1, FILTER_SHAPE)
        inside = np.abs(steps) <= FILTER_REACH * slower
        self._weights: Samples = np.zeros(steps.shape, np.float32)  # (up, taps) by the position between two samples
        self._weights[inside] = (np.sinc(steps / slower)[inside]) * window[steps[inside] + FILTER_REACH * slower]
        self._weights *= self._up / slower
        self._kept: Samples = np.zeros(self._side, np.float32)  # samples that later results need
        self._next = 0  # position of the next result, in 1 / up of a sample after the first complete window

    def feed(self, samples: Samples) -> Samples:
        """Convert the next samples (k,) of the stream, and return samples (m,)."""
        if self._up == self._down:
            return samples
        sound = np.concatenate([self._kept, np.asarray(samples, np.float32)])
        complete = len(sound) - 2 * self._side
        if complete <= 0:
            self._kept = sound
            return sound[:0]
        places = np.arange(self._next, complete * self._up, self._down)
        around = sliding_window_view(sound, 2 * self._side + 1)
        result = np.einsum("ij,ij->i", around[places // self._up], self._weights[places % self._up])
        self._next = (
            int(places[-1]) + self._down - complete * self._up if len(places) else self._next - complete * self._up
        )
        self._kept = sound[complete:]
        return np.asarray(result, np.float32)
