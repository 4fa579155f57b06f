"""The newest command, in memory that two processes share; whoever writes never waits for whoever reads."""

from collections.abc import Mapping
from dataclasses import dataclass
from multiprocessing.context import SpawnContext

import numpy as np

from kinesic.body.action_units import CHANNELS
from kinesic.face.assets.action_units import intensities

FACE = 5  # first place of the intensities; before them number, time and turn
LATEST = 5.0  # [s] that the last command waits for a reader


@dataclass(frozen=True)
class ShownFace:
    """What is to be drawn."""

    number: int  # of the command, from 1; 0: none yet
    time: float  # [s] performance time
    turn: tuple[float, float, float]  # [rad] of the head
    units: Mapping[str, float]  # action unit -> 0..1


class SharedCommand:
    """The newest command as a row of shared memory, which a child process gets when it is started."""

    def __init__(self, context: SpawnContext) -> None:
        self._row = context.RawArray("d", FACE + len(CHANNELS))
        self._lock = context.Lock()
        self._over = context.Event()

    def write(self, shown: ShownFace, *, wait: bool = False) -> bool:
        """Writes the newest command; False when the reader is reading, and this one is passed over.

        Args:
            shown: what is to be drawn.
            wait: for the reader, as the last command does.

        Raises:
            DisplayError: an unknown action unit, or an intensity outside 0..1.
        """
        row = np.concatenate([[shown.number, shown.time, *shown.turn], intensities(shown.units)])
        if not self._lock.acquire(timeout=LATEST if wait else 0.0):
            return False
        try:
            self._row[:] = row.tolist()
        finally:
            self._lock.release()
        return True

    def read(self) -> ShownFace:
        """Reads the newest command."""
        with self._lock:
            number, time, left, up, over, *units = self._row[:]
        shown = {channel: value for channel, value in zip(CHANNELS, units, strict=True) if value > 0.0}
        return ShownFace(int(number), time, (left, up, over), shown)

    def end(self) -> None:
        """Says that no command is to come."""
        self._over.set()

    @property
    def over(self) -> bool:
        """Whether no command is to come."""
        return self._over.is_set()
