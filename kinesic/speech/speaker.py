"""Plays sounds on a loudspeaker, each at its time on a clock."""

import time

import numpy as np

from kinesic.body.utterance import Samples, Sound
from kinesic.speech.loudspeaker import Clock, Device, PortAudio

SAMPLE_RATE = 44100  # [Hz]
JUMP = 0.01  # [s] by which a device may misjudge when it is heard, before that is believed


class Speaker:
    """Plays sounds, each at its time on a clock; several at once are mixed.

    The device is open from the beginning, so that nobody waits for it in the middle of a performance.
    """

    def __init__(self, clock: Clock = time.monotonic, *, device: Device | None = None, rate: int = SAMPLE_RATE) -> None:
        """Opens a device, by default the machine's own.

        Args:
            clock: [s] that times are given on.
            device: what is played on.
            rate: [Hz] of the device; sounds of other rates are interpolated.

        Raises:
            SpeakerError: nothing can be played here.
        """
        self._clock = clock
        self._device = PortAudio(clock) if device is None else device
        self._rate = rate
        self._next = float("-inf")  # time on the clock at which the next sample is heard
        self._playing: tuple[tuple[float, Sound], ...] = ()
        self._device.open(rate, self._feed)

    @property
    def latency(self) -> float:
        """[s] from handing samples over until they are heard, as last measured."""
        return self._device.latency

    def play(self, sound: Sound, at: float) -> None:
        """Plays a sound so that its first sample is heard at a time on the clock; what is past by then is left out."""
        now = self._clock()
        going_on = (each for each in self._playing if each[0] + each[1].duration > now)
        self._playing = (*going_on, (at, sound))

    def stop(self) -> None:
        """Drops all sounds: silent as soon as what the device has already is over."""
        self._playing = ()

    def close(self) -> None:
        """Ends all sounds at once, and closes the device."""
        self.stop()
        self._device.close()

    def _feed(self, count: int, at: float) -> Samples:
        """Mixes the next samples; they follow on where the device misjudges its time by a little."""
        begin = self._next if abs(at - self._next) < JUMP else at
        self._next = begin + count / self._rate
        return mix(self._playing, begin, count, self._rate)


def mix(playing: tuple[tuple[float, Sound], ...], begin: float, count: int, rate: int) -> Samples:
    """Mixes (count,) samples -1..1 of all sounds from a time on, at a rate [Hz].

    Args:
        playing: each sound after the time of its first sample [s].
        begin: [s] of the first sample wanted.
        count: of samples.
        rate: [Hz] of them; a sound of another rate is interpolated.
    """
    found = np.zeros(count, dtype=np.float32)
    for at, sound in playing:
        places = round((begin - at) * sound.rate) + np.arange(count) * (sound.rate / rate)
        first, last = max(0, int(places[0])), int(places[-1]) + 2
        part = sound.samples[first:last] if last > 0 else sound.samples[:0]
        if len(part):
            found += np.interp(places, np.arange(first, first + len(part)), part, left=0.0, right=0.0)
    return np.clip(found, -1.0, 1.0)
