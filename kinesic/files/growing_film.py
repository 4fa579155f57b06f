"""Reads an animated WebP while it is still being written, picture by picture."""

import os
import time
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from kinesic.body.arrays import Picture

BEGIN = 12  # bytes before the first chunk: RIFF, the size of what follows, WEBP
PLACE = 16  # bytes of a picture's chunk before its pixels: left and top halved, width, height, time, flags
PAUSE = 0.004  # [s] between looks at a film that has not grown
WRITER_TIMEOUT = 60.0  # [s] without a new picture, after which nobody seems to write it


class GrowingFilm:
    """A film of `WebpFilm` whose pictures are asked for one after another, from when its file is there.

    Whoever cannot complete the film has to remove its file, so that nobody waits for the rest.
    """

    def __init__(self, path: Path) -> None:
        """Begins before the first picture.

        Args:
            path: of the file, which may still be empty.

        Raises:
            OSError: it is not there.
        """
        path.stat()
        self._path, self._patience = path, WRITER_TIMEOUT
        self._next, self._ends = BEGIN, 0.0  # [bytes] where the next chunk begins; [s] when the picture does
        self._picture: Picture | None = None

    def at(self, moment: float) -> Picture | None:
        """(height, width, 3) the picture of a time [s], waited for; times never decrease. None: it never comes."""
        while self._picture is None or self._ends <= moment:
            chunk = self._chunk()
            if chunk is None:
                return None
            if not chunk:  # the last picture stays
                break
            if chunk.startswith(b"ANMF"):
                self._take(chunk[8:])
        return self._picture

    def _take(self, shown: bytes) -> None:
        """Puts a picture, or the part of it that has changed, where it is seen."""
        left, top, _, _, milliseconds = (int.from_bytes(shown[k : k + 3], "little") for k in range(0, PLACE - 1, 3))
        pixels = shown[PLACE:]
        size = (len(pixels) + 4).to_bytes(4, "little")
        part = np.asarray(Image.open(BytesIO(b"RIFF" + size + b"WEBP" + pixels)).convert("RGB"))
        whole = part.copy() if self._picture is None else self._picture.copy()
        whole[2 * top : 2 * top + len(part), 2 * left : 2 * left + part.shape[1]] = part
        self._picture, self._ends = whole, self._ends + milliseconds / 1000

    def _chunk(self) -> bytes | None:
        """The next chunk with its head, nothing where the film is complete; None where it breaks off."""
        begun = time.monotonic()
        with suppress(FileNotFoundError), self._path.open("rb", buffering=0) as file:
            while self._path.exists() and time.monotonic() - begun < self._patience:
                written = int.from_bytes(os.pread(file.fileno(), 4, 4), "little")  # known when it is complete
                size = int.from_bytes(os.pread(file.fileno(), 4, self._next + 4), "little")
                chunk = os.pread(file.fileno(), 8 + size + size % 2, self._next)
                if size and len(chunk) == 8 + size + size % 2:
                    self._next += len(chunk)
                    return chunk
                if written and self._next >= written + 8:
                    return b""
                time.sleep(PAUSE)
        self._patience = 0.0  # nobody waits twice
        return None
