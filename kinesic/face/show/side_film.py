"""The robot's body beside its face: a film of it, shown in step."""

from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from kinesic.face.display import DisplayError
from kinesic.face.render.portrait import Pixels


class Beside:
    """An animated picture that is read as time goes on; only one of its pictures is held."""

    def __init__(self, path: Path, height: int) -> None:
        """Opens a film.

        Args:
            path: of an animated WebP on the clock of the performance.
            height: of its pictures as they are shown [pixels].

        Raises:
            DisplayError: it cannot be read.
        """
        try:
            self._film = Image.open(path)
            self._film.load()
        except (OSError, UnidentifiedImageError) as error:
            raise DisplayError(f"{path}: no film: {error}") from None
        self._size = (round(self._film.width * height / self._film.height), height)
        self._last = getattr(self._film, "n_frames", 1) - 1

    def at(self, time: float) -> Pixels:
        """(height, width, 3) the picture of a time [s]; times never decrease."""
        while self._film.tell() < self._last and self._ends() <= time:
            self._film.seek(self._film.tell() + 1)
            self._film.load()
        return np.asarray(self._film.convert("RGB").resize(self._size))

    def _ends(self) -> float:
        """[s] when the next picture takes the place of this one."""
        return float(self._film.info["timestamp"] + self._film.info["duration"]) / 1000.0
