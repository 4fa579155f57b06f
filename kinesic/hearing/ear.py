"""Streaming ear: from microphone samples to conversation events."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kinesic.body.utterance import Samples
from kinesic.hearing.barge_in import BargeInDecision, BargeInDetector
from kinesic.hearing.echo import EchoCanceller
from kinesic.hearing.own_voice import OwnVoiceGate
from kinesic.hearing.resampling import StreamResampler
from kinesic.hearing.voice_activity import FRAME_SIZE, VOICE_RATE, VoiceDetector

FRAME_DURATION = FRAME_SIZE / VOICE_RATE  # [s] duration of a frame
NO_SAMPLES = np.zeros(0, np.float32)


@dataclass(frozen=True)
class HeardChange:
    """Reaction to a voice in the stream, with its time."""

    decision: BargeInDecision
    time: float  # [s] time in the stream at which the reaction was decided
    age: float  # [s] time since the voice began or ended


class Ear:
    """Detector of people's voices in a microphone, without the robot's own voice."""

    def __init__(self, rate: int = VOICE_RATE) -> None:
        """Create an ear at the start of a stream.

        Args:
            rate: sample rate [Hz] of microphone and playback.

        Raises:
            ValueError: the rate is outside the range of microphones.
        """
        self._heard, self._played = StreamResampler(rate, VOICE_RATE), StreamResampler(rate, VOICE_RATE)
        self._waiting = [NO_SAMPLES, NO_SAMPLES]  # samples of microphone and playback for the next frame
        self._canceller, self._gate = EchoCanceller(), OwnVoiceGate()
        self._detector, self._turns = VoiceDetector(), BargeInDetector()
        self._frames = 0
        self.probability = 0.0  # probability of a voice in the last frame

    def hear(self, heard: Samples, played: Samples | None = None) -> Iterator[HeardChange]:
        """Yield the reactions to voices in the next samples.

        Args:
            heard: (k,) samples of the microphone in -1..1.
            played: (k,) samples of the robot's loudspeaker in the same time; None: it is silent, or its echo is
                cancelled elsewhere.

        Raises:
            ValueError: the two have different lengths.
        """
        played = np.zeros(len(heard), np.float32) if played is None else played
        if len(played) != len(heard):
            raise ValueError(f"{len(played)} samples played and {len(heard)} heard: both must have the same length")
        for index, new in enumerate((self._heard.feed(heard), self._played.feed(played))):
            self._waiting[index] = np.concatenate([self._waiting[index], new])
        while len(self._waiting[0]) >= FRAME_SIZE:
            frame, own = (samples[:FRAME_SIZE] for samples in self._waiting)
            self._waiting = [samples[FRAME_SIZE:] for samples in self._waiting]
            change = self._step(frame, own)
            if change is not None:
                yield change

    def _step(self, frame: Samples, own: Samples) -> HeardChange | None:
        """Process a frame of the microphone and of the playback."""
        cleaned, echo = self._canceller.cancel(frame, own)
        self.probability = self._detector.probability(cleaned)
        self._frames += 1
        change = self._turns.step(self.probability, admitted=self._gate.admits(cleaned, echo))
        if change is None:
            return None
        decision, age = change
        return HeardChange(decision, self._frames * FRAME_DURATION, age * FRAME_DURATION)
