"""Speech sound of a client, which the robot performs as its own."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.body.arrays import Floats
from kinesic.body.utterance import Sound


@dataclass(frozen=True, eq=False)
class ForeignSound:
    """Received part of a client's speech sound, with the robot's mouth."""

    id: str
    begin: float  # [s] global time of the first sample
    duration: float  # [s] duration of the received part
    is_complete: bool  # whether no further part follows
    pieces: tuple[tuple[float, Sound], ...]  # global start [s] and sound of each part to be played
    face_begin: float  # [s] global time of the first row of `face`
    face: Mapping[str, Floats]  # action unit -> (m,) intensities 0..1 at 100 Hz

    @property
    def end(self) -> float:
        """Global time [s] at which the received part ends."""
        return self.begin + self.duration

    def position(self, time: float) -> float:
        """Return the position [s] in the sound at a global time [s]."""
        return round(min(max(time - self.begin, 0.0), self.duration), 3)
