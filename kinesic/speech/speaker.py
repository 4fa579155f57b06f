"""Playback of sounds on a loudspeaker at times on a clock."""

import time

import numpy as np

from kinesic.body.utterance import Samples, Sound
from kinesic.speech.loudspeaker import Clock, Device, PortAudio

SAMPLE_RATE = 44100  # [Hz] sample rate of the loudspeaker
MAX_TIME_JITTER = 0.01  # [s] jumps of the device's reported time up to this size are ignored


class Speaker:
    """Mixer that plays each sound at a given time on a clock.

    The device is open from the start, so that no performance has to wait for it.
    """

    def __init__(self, clock: Clock = time.monotonic, *, device: Device | None = None, rate: int = SAMPLE_RATE) -> None:
        """Open a sound output, by default that of the machine.

        Args:
            clock: clock of all times [s].
            device: device to play on.
            rate: sample rate of the device [Hz]; sounds with other rates are interpolated.

        Raises:
            SpeakerError: no sound can be played.
        """
        self._clock = clock
        self._device = PortAudio(clock) if device is None else device
        self._rate = rate
        self._next = float("-inf")  # time on the clock at which the next sample is heard
        self._playing: tuple[tuple[float, Sound], ...] = ()
        self._device.open(rate, self._mix_next)

    @property
    def latency(self) -> float:
        """Last measured delay [s] from requesting samples to hearing them."""
        return self._device.latency

    def play(self, sound: Sound, at: float) -> None:
        """Schedule a sound for a time [s] on the speaker's clock.

        The part before the current time is left out.
        """
        now = self._clock()
        current = (entry for entry in self._playing if entry[0] + entry[1].duration > now)
        self._playing = (*current, (at, sound))

    def stop(self) -> None:
        """Discard all playing and scheduled sounds.

        Samples that the device already has are still heard.
        """
        self._playing = ()

    def close(self) -> None:
        """Stop all sounds at once and close the device."""
        self.stop()
        self._device.close()

    def _mix_next(self, count: int, at: float) -> Samples:
        """Mix the next samples for the sound output.

        They continue the previous ones if the device's time differs only slightly.
        """
        begin = self._next if abs(at - self._next) < MAX_TIME_JITTER else at
        self._next = begin + count / self._rate
        return mix(self._playing, begin, count, self._rate)


def mix(playing: tuple[tuple[float, Sound], ...], begin: float, count: int, rate: int) -> Samples:
    """Mix overlapping sounds to samples (count,) in -1..1.

    Args:
        playing: sounds with the times of their first samples [s].
        begin: time of the first sample [s].
        count: number of samples.
        rate: sample rate [Hz]; sounds with other rates are interpolated.
    """
    mixed = np.zeros(count, dtype=np.float32)
    for at, sound in playing:
        positions = round((begin - at) * sound.rate) + np.arange(count) * (sound.rate / rate)
        first, last = max(0, int(positions[0])), int(positions[-1]) + 2
        part = sound.samples[first:last] if last > 0 else sound.samples[:0]
        if len(part):
            mixed += np.interp(positions, np.arange(first, first + len(part)), part, left=0.0, right=0.0)
    return np.clip(mixed, -1.0, 1.0)
