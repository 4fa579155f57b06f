"""Newest command in memory shared by two processes, without blocking the writer."""

from collections.abc import Mapping
from dataclasses import dataclass
from multiprocessing.context import SpawnContext

import numpy as np

from kinesic.body.action_units import FACE_CHANNELS
from kinesic.face.assets.action_units import read_intensities

INTENSITIES_START = 5  # index of the first intensity in shared memory, after command number, time and head rotation
WRITE_TIMEOUT = 5.0  # [s] longest wait until the last command is written


@dataclass(frozen=True)
class ShownFace:
    """Action units, time and head rotation of the face to draw."""

    number: int  # number of the command from 1; 0 before the first
    time: float  # [s] performance time
    turn: tuple[float, float, float]  # [rad] head rotation
    units: Mapping[str, float]  # action unit -> 0..1


class SharedCommand:
    """Newest command in shared memory, passed to a starting child process."""

    def __init__(self, context: SpawnContext) -> None:
        self._row = context.RawArray("d", INTENSITIES_START + len(FACE_CHANNELS))
        self._lock = context.Lock()
        self._over = context.Event()

    def write(self, shown: ShownFace, *, wait: bool = False) -> bool:
        """Write the newest command to shared memory, unless the reader is busy.

        The result tells whether it was written.

        Args:
            shown: face to draw.
            wait: whether to wait for the reader, as for the last command.

        Raises:
            DisplayError: an unknown action unit, or an intensity outside 0..1.
        """
        row = np.concatenate([[shown.number, shown.time, *shown.turn], read_intensities(shown.units)])
        if not self._lock.acquire(timeout=WRITE_TIMEOUT if wait else 0.0):
            return False
        try:
            self._row[:] = row.tolist()
        finally:
            self._lock.release()
        return True

    def read(self) -> ShownFace:
        """Return the newest command from shared memory."""
        with self._lock:
            number, time, left, up, over, *units = self._row[:]
        shown = {channel: value for channel, value in zip(FACE_CHANNELS, units, strict=True) if value > 0.0}
        return ShownFace(int(number), time, (left, up, over), shown)

    def end(self) -> None:
        """Signal through shared memory that no further command follows."""
        self._over.set()

    @property
    def is_over(self) -> bool:
        """Whether the last command was written."""
        return self._over.is_set()
