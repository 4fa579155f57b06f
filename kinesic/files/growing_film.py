"""Reading of an animated WebP film while another process writes it."""

import time
from contextlib import suppress
from io import BytesIO, RawIOBase
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.files.late_pillow import Image

FILE_HEADER_SIZE = 12  # [bytes] size of the WebP file header: RIFF, file size and WEBP
PICTURE_HEADER_SIZE = 16  # [bytes] size of a picture header: left / 2, top / 2, width, height, duration, flags
POLL_INTERVAL = 0.004  # [s] interval between checks of the file's size
WRITER_TIMEOUT = 60.0  # [s] waiting time for a new picture, after which the writer counts as dead


class GrowingFilm:
    """Reader of a film that `WebpFilm` is still writing.

    A writer that cannot complete the film must remove its file, so that no reader waits for the rest.
    """

    def __init__(self, path: Path) -> None:
        """Open a growing film by its path, which must exist.

        Args:
            path: path of the file, which may still be empty.

        Raises:
            OSError: the file is missing.
        """
        path.stat()
        self._path, self._patience = path, WRITER_TIMEOUT
        self._next, self._ends = FILE_HEADER_SIZE, 0.0  # [bytes] offset of the next chunk; [s] start of its picture
        self._picture: Picture | None = None

    def at(self, time_s: float) -> Picture | None:
        """Wait for the film's picture (height, width, 3) at a time [s].

        Times must not decrease. After the end it is the last picture; None if the film breaks off before the time.
        """
        while self._picture is None or self._ends <= time_s:
            chunk = self._read_chunk()
            if chunk is None:
                return None
            if not chunk:  # the last picture remains
                break
            if chunk.startswith(b"ANMF"):
                self._draw_region(chunk[8:])
        return self._picture

    def _draw_region(self, shown: bytes) -> None:
        """Draw a changed region into the film's current picture."""
        left, top, _, _, milliseconds = (
            int.from_bytes(shown[k : k + 3], "little") for k in range(0, PICTURE_HEADER_SIZE - 1, 3)
        )
        pixels = shown[PICTURE_HEADER_SIZE:]
        size = (len(pixels) + 4).to_bytes(4, "little")
        part = np.asarray(Image.open(BytesIO(b"RIFF" + size + b"WEBP" + pixels)).convert("RGB"))
        whole = part.copy() if self._picture is None else self._picture.copy()
        whole[2 * top : 2 * top + len(part), 2 * left : 2 * left + part.shape[1]] = part
        self._picture, self._ends = whole, self._ends + milliseconds / 1000

    def _read_chunk(self) -> bytes | None:
        """Wait for the next WebP chunk and return it with its header.

        Returns b"" at the end of the film, and None if the film breaks off.
        """
        begun = time.monotonic()
        with suppress(FileNotFoundError), self._path.open("rb", buffering=0) as file:
            while self._path.exists() and time.monotonic() - begun < self._patience:
                written = int.from_bytes(_read_at(file, 4, 4), "little")  # nonzero once the film is complete
                size = int.from_bytes(_read_at(file, 4, self._next + 4), "little")
                chunk = _read_at(file, 8 + size + size % 2, self._next)
                if size and len(chunk) == 8 + size + size % 2:
                    self._next += len(chunk)
                    return chunk
                if written and self._next >= written + 8:
                    return b""
                time.sleep(POLL_INTERVAL)
        self._patience = 0.0  # later calls do not wait again
        return None


def _read_at(file: RawIOBase, size: int, offset: int) -> bytes:
    """Read bytes at an offset of an unbuffered file."""
    file.seek(offset)
    return file.read(size) or b""
