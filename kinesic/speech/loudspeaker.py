"""What a loudspeaker is to those who play on it."""

from collections.abc import Callable
from typing import Protocol

from kinesic.body.utterance import Samples

Clock = Callable[[], float]
Feed = Callable[[int, float], Samples]  # so many samples, heard from this time on the clock -> the samples


class SpeakerError(RuntimeError):
    """Nothing can be played here; the text tells why, and what mends it."""


class Device(Protocol):
    """Something that plays samples as they come."""

    @property
    def latency(self) -> float:
        """[s] from asking for samples until they are heard, as last measured."""

    def open(self, rate: int, feed: Feed) -> None:
        """Begins to ask for samples of one channel at a rate [Hz], again and again.

        Raises:
            SpeakerError: there is nothing to play on.
        """

    def close(self) -> None:
        """Ends that."""
