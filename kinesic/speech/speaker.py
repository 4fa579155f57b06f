"""Playback of sounds on a loudspeaker at times on a clock."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from kinesic.body.utterance import Samples, Sound
from kinesic.speech.loudspeaker import Clock, Device, PortAudio

SAMPLE_RATE = 44100  # [Hz] sample rate of the loudspeaker
MAX_TIME_JITTER = 0.01  # [s] jumps of the device's reported time up to this size are ignored
MAX_MUTE_DURATION = 5.0  # [s] longest mute by one request, in case nobody ends it
FADE_DURATION = 0.04  # [s] fade-out of a sound that ends early, long enough to be free of clicks


@dataclass(frozen=True, eq=False)
class PlayedSound:
    """Sound with its start on the speaker's clock."""

    sound: Sound
    begin: float  # [s] time of its first sample
    fade: float = inf  # [s] time at which the sound begins to fade out

    @property
    def end(self) -> float:
        """Time [s] after which the sound is silent."""
        return min(self.begin + self.sound.duration, self.fade + FADE_DURATION)


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
        self._playing: tuple[PlayedSound, ...] = ()
        self._muted_until, self._gain = -inf, 1.0  # [s] on the clock; gain of the last sample
        self.monitor: Callable[[Samples], None] | None = None  # called with all samples that the device gets
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
        current = (entry for entry in self._playing if entry.end > now)
        self._playing = (*current, PlayedSound(sound, at))

    def fade_out(self, sound: Sound, at: float) -> None:
        """Fade out the sound that was scheduled for a time [s].

        Samples that the device already has are still heard before the fade.
        """
        now = max(self._clock(), self._next)
        self._playing = tuple(
            replace(entry, fade=min(entry.fade, now)) if entry.sound is sound and entry.begin == at else entry
            for entry in self._playing
        )

    def mute(self, *, on: bool) -> None:
        """Mute all sounds without stopping them, or unmute them.

        Without another request, they fade in after `MAX_MUTE_DURATION`.
        """
        self._muted_until = self._clock() + MAX_MUTE_DURATION if on else -inf

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
        mixed = mix(self._playing, begin, count, self._rate) * self._gains(begin, count)
        if self.monitor is not None:
            self.monitor(mixed)
        return mixed

    def _gains(self, begin: float, count: int) -> Samples:
        """Return the gains (count,) of the next samples, which change within `FADE_DURATION`."""
        change = np.arange(1, count + 1) / (FADE_DURATION * self._rate)
        gains = np.clip(self._gain + (-change if begin < self._muted_until else change), 0.0, 1.0)
        self._gain = float(gains[-1])
        return np.asarray(gains, np.float32)


def mix(playing: tuple[PlayedSound, ...], begin: float, count: int, rate: int) -> Samples:
    """Mix overlapping sounds to samples (count,) in -1..1.

    Args:
        playing: sounds with their times.
        begin: time of the first sample [s].
        count: number of samples.
        rate: sample rate [Hz]; sounds with other rates are interpolated.
    """
    mixed = np.zeros(count, dtype=np.float32)
    for entry in playing:
        sound = entry.sound
        positions = round((begin - entry.begin) * sound.rate) + np.arange(count) * (sound.rate / rate)
        first, last = max(0, int(positions[0])), int(positions[-1]) + 2
        part = sound.samples[first:last] if last > 0 else sound.samples[:0]
        if len(part):
            heard = np.interp(positions, np.arange(first, first + len(part)), part, left=0.0, right=0.0)
            mixed += heard if entry.fade == inf else heard * _fade_gains(entry, begin, count, rate)
    return np.clip(mixed, -1.0, 1.0)


def _fade_gains(entry: PlayedSound, begin: float, count: int, rate: int) -> Samples:
    """Return the gains (count,) of a raised-cosine fade-out."""
    progress = np.clip((begin + np.arange(count) / rate - entry.fade) / FADE_DURATION, 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * progress), dtype=np.float32)
