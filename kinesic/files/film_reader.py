"""Sequential reading of animated WebP films, with one picture in memory."""

from pathlib import Path

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.files.late_pillow import Image


class FilmReader:
    """Reader of an animated WebP, whose pictures are read in order."""

    def __init__(self, path: Path) -> None:
        """Open a film whose pictures are read in order of time.

        Args:
            path: path of an animated WebP.

        Raises:
            OSError: the file cannot be read, or is not a film.
        """
        self._film = Image.open(path)
        self._film.load()
        self.size: tuple[int, int] = (self._film.width, self._film.height)
        self._last = getattr(self._film, "n_frames", 1) - 1
        self._seen: tuple[int, Picture] | None = None

    def at(self, time: float) -> Picture:
        """Return the film's picture (height, width, 3) at a time [s].

        Times must not decrease.
        """
        while self._film.tell() < self._last and self._ends() <= time:
            self._film.seek(self._film.tell() + 1)
            self._film.load()
        if self._seen is None or self._seen[0] != self._film.tell():
            self._seen = (self._film.tell(), np.asarray(self._film.convert("RGB")))
        return self._seen[1]

    def _ends(self) -> float:
        """Return the end time [s] of the film's current picture."""
        return float(self._film.info["timestamp"] + self._film.info["duration"]) / 1000.0
