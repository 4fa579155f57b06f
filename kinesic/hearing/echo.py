"""Cancellation of the robot's own voice in the sound of its microphone.

The echo path from the loudspeaker to the microphone is estimated by a Kalman filter in the frequency domain, in
partitions of one frame (Enzner and Vary 2006, Kuech et al. 2014). The filter adapts while both voices sound, because
the variance of its error, rather than a double-talk detector, determines the step.
"""

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.utterance import Samples
from kinesic.hearing.voice_activity import FRAME_SIZE, VOICE_RATE

ECHO_TAIL = 0.25  # [s] longest delay of an echo after its sound
FORGETTING_FACTOR = 0.998  # factor per frame on the estimated echo path: its time constant is 16 s
INITIAL_VARIANCE = 1.0  # variance of an unknown echo path, whose gains are below 1
NOISE_SMOOTHING = 0.7  # factor on the previous power spectrum of noise and other voices
MIN_POWER = 1e-9  # power below the noise of any microphone, added to avoid division by zero

Spectra = NDArray[np.complex128]


class EchoCanceller:
    """Streaming filter that removes the echo of known sounds."""

    def __init__(self) -> None:
        """Create a filter without an estimate of the echo path."""
        partitions, frequencies = round(ECHO_TAIL * VOICE_RATE / FRAME_SIZE), FRAME_SIZE + 1
        self._played: Spectra = np.zeros((partitions, frequencies), np.complex128)  # newest partition first
        self._path: Spectra = np.zeros((partitions, frequencies), np.complex128)
        self._powers = np.zeros((partitions, frequencies))  # power spectra of the partitions
        self._variance = np.full((partitions, frequencies), INITIAL_VARIANCE)
        self._noise = np.zeros(frequencies)
        self._last = np.zeros(FRAME_SIZE)

    def cancel(self, heard: Samples, played: Samples) -> tuple[Samples, Samples]:
        """Return the next frame without the echo, and the estimated echo.

        Args:
            heard: (512,) samples of the microphone at 16 kHz.
            played: (512,) samples of the loudspeaker in the same frame; their echo may come up to 0.25 s later.
        """
        spectrum = np.fft.rfft(np.concatenate([self._last, played]))
        for rows, newest in ((self._played, spectrum), (self._powers, np.abs(spectrum) ** 2)):
            rows[1:] = rows[:-1]
            rows[0] = newest
        self._last = np.asarray(played, np.float64)
        if self._played.any():
            self._adapt(heard - self._echo())
        echo = np.asarray(self._echo(), np.float32)
        return np.asarray(heard - echo, np.float32), echo

    def _echo(self) -> Floats:
        """Estimate the echo (512,) in the current frame."""
        return np.asarray(np.fft.irfft((self._path * self._played).sum(axis=0))[FRAME_SIZE:])

    def _adapt(self, residual: Floats) -> None:
        """Correct the estimated path by the residual (512,) of a frame."""
        spectrum = np.fft.rfft(np.concatenate([np.zeros(FRAME_SIZE), residual]))
        self._noise = NOISE_SMOOTHING * self._noise + (1.0 - NOISE_SMOOTHING) * np.abs(spectrum) ** 2
        error_power = 0.5 * (self._powers * self._variance).sum(axis=0) + self._noise + MIN_POWER
        step = 0.5 * self._variance / error_power
        change = np.fft.irfft(step * np.conj(self._played) * spectrum, axis=1)
        change[:, FRAME_SIZE:] = 0.0  # a partition is one frame long
        self._path = FORGETTING_FACTOR * (self._path + np.fft.rfft(change, axis=1))
        remaining = FORGETTING_FACTOR**2 * (1.0 - 0.5 * step * self._powers) * self._variance
        self._variance = remaining + (1.0 - FORGETTING_FACTOR**2) * np.abs(self._path) ** 2
