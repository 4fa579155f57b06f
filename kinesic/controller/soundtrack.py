"""Mixes the utterances of a plan on performance time, and plays them in step with the servos."""

import wave
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import gcd
from pathlib import Path

import numpy as np

from kinesic.bml.block import Speech
from kinesic.body.utterance import Samples, Sound
from kinesic.controller.servo_performance import FULL_PACE
from kinesic.hardware.supervisor.channel import Status
from kinesic.planning.plan import Plan
from kinesic.speech.loudspeaker import SpeakerError
from kinesic.speech.speaker import Speaker

LARGEST_SAMPLE = 32767  # of a sample of 16 bits
MAX_RATE = 48_000  # [Hz] of the mix: one short part at a high rate must not multiply the memory of all others
ASTRAY = 0.03  # [s] between the robot's time and the sound's beyond which the sound is put right


def sound(plan: Plan) -> Sound | None:
    """Mixes the utterances of a plan.

    Returns:
        One channel from performance time 0 to the end of the performance, at the highest rate of its parts up to
        `MAX_RATE`; None when nothing is heard.
    """
    parts = [
        (plan.trajectory.zero + timed.times["start"], spoken)
        for timed in plan.timeline.timed
        if isinstance(timed.behaviour.action, Speech)
        and (spoken := plan.utterances[timed.behaviour.id].sound) is not None
    ]
    if not parts:
        return None
    rate = min(max(spoken.rate for _, spoken in parts), MAX_RATE)
    pieces = [(round(begin * rate), resample(spoken, rate)) for begin, spoken in parts]
    length = max(round(plan.duration * rate), *(first + len(piece) for first, piece in pieces))
    mixed: Samples = np.zeros(length, dtype=np.float32)
    for first, piece in pieces:
        mixed[first : first + len(piece)] += piece
    mixed /= max(1.0, float(mixed.max(initial=0.0)), -float(mixed.min(initial=0.0)))  # in place: it may be long
    return Sound.of(rate, mixed)


def resample(spoken: Sound, rate: int) -> Samples:
    """Converts the samples (m,) of a sound to another rate [Hz]."""
    if spoken.rate == rate:
        return spoken.samples
    from scipy.signal import resample_poly  # noqa: PLC0415 - slow to import, and voices seldom differ

    common = gcd(spoken.rate, rate)
    samples: Samples = resample_poly(spoken.samples, rate // common, spoken.rate // common)
    return samples


def write_wav(spoken: Sound, path: Path) -> None:
    """Writes a sound as WAV: one channel of 16 bits."""
    whole = np.round(LARGEST_SAMPLE * np.clip(spoken.samples, -1.0, 1.0)).astype("<i2")
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(spoken.rate)
        file.writeframes(whole.tobytes())


class SpeechPlayback:
    """Speech in step with the servos, silent while performance time stands or changes its pace."""

    def __init__(self, sound: Sound, speaker: Speaker) -> None:
        """Silent at first.

        Args:
            sound: on performance time, from its 0.
            speaker: whose clock is the machine's monotonic one, as the supervisor's is.
        """
        self._sound, self._speaker = sound, speaker
        self._zero: float | None = None  # [s] on the clock of performance time 0; None: silent

    def __call__(self, status: Status) -> None:
        """Follows the status of the servos."""
        if not status.stage.runs or not status.scale > FULL_PACE:
            self._hush()
            return
        zero = status.clock - status.time
        if self._zero is not None and abs(zero - self._zero) <= ASTRAY:
            return
        self._hush()
        self._speaker.play(self._sound, zero)
        self._zero = zero

    def _hush(self) -> None:
        if self._zero is not None:
            self._speaker.stop()
            self._zero = None


@contextmanager
def open_speaker(warn: Callable[[str], None]) -> Iterator[Speaker | None]:
    """Opens the machine's loudspeaker meanwhile; where nothing can be heard it is None, and `warn` gets the reason."""
    try:
        speaker = Speaker()
    except SpeakerError as error:
        warn(f"voice: not heard ({error})")
        yield None
        return
    try:
        yield speaker
    finally:
        speaker.close()


@contextmanager
def speak_along(plan: Plan, warn: Callable[[str], None]) -> Iterator[Callable[[Status], None]]:
    """Speaks what a plan says at the time to which servos have come, where there is a loudspeaker.

    Args:
        plan: what is performed.
        warn: gets the reason where nothing can be heard.

    Yields:
        What must be called with every status of the servos.
    """
    mixed = sound(plan)
    if mixed is None:
        yield lambda status: None
        return
    with open_speaker(warn) as speaker:
        yield SpeechPlayback(mixed, speaker) if speaker is not None else lambda status: None
