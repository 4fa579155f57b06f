"""Speech of a plan, mixed and played in sync with the servos."""

import wave
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import gcd
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from kinesic.bml.block import Speech
from kinesic.body.utterance import Samples, Sound
from kinesic.hardware.supervisor.channel import Status
from kinesic.metrics.servo_run import FULL_TIME_SCALE
from kinesic.planning.plan import Plan
from kinesic.speech.loudspeaker import SpeakerError
from kinesic.speech.speaker import Speaker

MAX_SAMPLE_VALUE = 32767  # largest value of a 16-bit sample
MAX_SAMPLE_RATE = 48_000  # [Hz] highest rate of the mix, which bounds the memory
FILTER_REACH = 10  # zero crossings of the resampling filter before and after its peak
FILTER_SHAPE = 5.0  # beta of the Kaiser window, for a stopband attenuation of 54 dB
MAX_SYNC_ERROR = 0.03  # [s] time error of the sound above which it restarts at the robot's position


def sound(plan: Plan) -> Sound | None:
    """Mix a plan's utterances into one sound, or return None.

    Returns:
        One channel from performance time 0 to the end, at the highest rate of its parts up to `MAX_SAMPLE_RATE`; None
        for a plan without audible speech. A motion may start up to 20 ms after the speech, which loses these samples.
    """
    parts = [
        (plan.trajectory.zero + timed.times["start"], spoken)
        for timed in plan.timeline.timed
        if isinstance(timed.behaviour.action, Speech)
        and (spoken := plan.utterances[timed.behaviour.id].sound) is not None
    ]
    if not parts:
        return None
    rate = min(max(spoken.rate for _, spoken in parts), MAX_SAMPLE_RATE)
    pieces = [(round(begin * rate), resample_sound(spoken, rate)) for begin, spoken in parts]
    length = max(round(plan.duration * rate), *(first + len(piece) for first, piece in pieces))
    mixed: Samples = np.zeros(length, dtype=np.float32)
    for first, piece in pieces:
        mixed[max(first, 0) : first + len(piece)] += piece[max(-first, 0) :]
    mixed /= max(1.0, float(mixed.max(initial=0.0)), -float(mixed.min(initial=0.0)))  # in place, as it may be long
    return Sound.of(rate, mixed)


def resample_sound(spoken: Sound, rate: int) -> Samples:
    """Convert the samples (m,) of a sound to another rate [Hz].

    Each new sample is a sum of the samples around it, weighted by the impulse response of an ideal low-pass filter that
    fades out. Every `up`-th new sample has the same weights, since it lies `down` samples later.
    """
    if spoken.rate == rate:
        return spoken.samples
    common = gcd(spoken.rate, rate)
    up, down = rate // common, spoken.rate // common
    reach = FILTER_REACH * max(up, down)  # of the impulse response, in samples at the common multiple of both rates
    response = np.sinc(np.arange(-reach, reach + 1) / max(up, down)) * np.kaiser(2 * reach + 1, FILTER_SHAPE)
    response = np.pad(response * (up / response.sum()), 2 * up).astype(np.float32)
    side = reach // up + 1  # samples before and after
    around = sliding_window_view(np.pad(spoken.samples, side), 2 * side + 1)
    samples: Samples = np.empty(-(-len(spoken.samples) * up // down), dtype=np.float32)
    for first in range(min(up, len(samples))):
        nearest, phase = divmod(first * down, up)
        weights = response[2 * up + reach + phase - up * np.arange(-side, side + 1)]
        samples[first::up] = around[nearest::down] @ weights
    return samples


def write_wav(spoken: Sound, file: Path | BinaryIO) -> None:
    """Write a sound as a WAV file: one channel of 16 bits."""
    integers = np.round(MAX_SAMPLE_VALUE * np.clip(spoken.samples, -1.0, 1.0)).astype("<i2")
    with wave.open(str(file) if isinstance(file, Path) else file, "wb") as writer:
        writer.setnchannels(1)
        writer.setsampwidth(2)
        writer.setframerate(spoken.rate)
        writer.writeframes(integers.tobytes())


class SpeechPlayback:
    """Speech playback in sync with the servos, silent during slowed motion."""

    def __init__(self, sound: Sound, speaker: Speaker) -> None:
        """Prepare the playback, silent until the first servo status.

        Args:
            sound: on performance time, from its 0.
            speaker: on the monotonic clock of the machine, like the supervisor.
        """
        self._sound, self._speaker = sound, speaker
        self._zero: float | None = None  # [s] clock at performance time 0; None: silent

    def __call__(self, status: Status) -> None:
        """Start, stop or realign the sound according to a servo status."""
        if not status.stage.runs or not status.scale > FULL_TIME_SCALE:
            self._silence()
            return
        zero = status.clock - status.time
        if self._zero is not None and abs(zero - self._zero) <= MAX_SYNC_ERROR:
            return
        self._silence()
        self._speaker.play(self._sound, zero)
        self._zero = zero

    def _silence(self) -> None:
        if self._zero is not None:
            self._speaker.stop()
            self._zero = None


@contextmanager
def open_speaker(warn: Callable[[str], None]) -> Iterator[Speaker | None]:
    """Open the loudspeaker, or warn with the reason and yield None."""
    try:
        speaker = Speaker()
    except SpeakerError as error:
        warn(f"voice: no sound ({error})")
        yield None
        return
    try:
        yield speaker
    finally:
        speaker.close()


@contextmanager
def speak_along(plan: Plan, warn: Callable[[str], None]) -> Iterator[Callable[[Status], None]]:
    """Play the speech of a plan in sync with the servos.

    Args:
        plan: being performed.
        warn: receives the reason if there is no sound.

    Yields:
        Function to be called with every status of the servos.
    """
    mixed = sound(plan)
    if mixed is None:
        yield lambda status: None
        return
    with open_speaker(warn) as speaker:
        yield SpeechPlayback(mixed, speaker) if speaker is not None else lambda status: None
