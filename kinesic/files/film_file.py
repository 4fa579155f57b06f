"""Writes films picture by picture, whatever their length: animated WebP, and H.264 where an encoder is installed."""

import shutil
import subprocess
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from importlib import import_module
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryFile
from types import TracebackType
from typing import BinaryIO, Protocol, Self

import numpy as np
from PIL import Image

from kinesic.body.arrays import Picture

PixelBox = tuple[int, int, int, int]  # left, top, right, bottom [pixels]; left and top are even

WEBP, MP4 = ".webp", ".mp4"
NO_ENCODER = "no encoder for .mp4: pip install imageio-ffmpeg, or apt-get install ffmpeg; .webp needs none"
ENCODING = (  # what every player plays; it wants even sides
    *("-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p"),
    *("-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv"),
    *("-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"),
    *("-movflags", "+faststart"),  # a browser shows its beginning before it has its end
)
QUALITY = 80  # of WebP, 0..100
THREADS, WAITING = 2, 6  # that encode, and pictures that may wait for them
WHOLE_PICTURE = 0b10  # a picture takes the place of what is below it


class EncodingError(RuntimeError):
    """A film cannot be encoded here: says why, and the line that mends it."""


class FilmFile(Protocol):
    """A film that is being written; a context manager that completes its file; after an error it is none."""

    def write(self, picture: Picture, changed: PixelBox | None, milliseconds: int, /) -> None:
        """Adds a picture, which differs from the one before in a box alone (None: anywhere), and is seen for a time."""

    def __enter__(self) -> Self:
        """Begins."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Completes the file."""


def open_film(path: Path, size: tuple[int, int], *, rate: float, sound: Path | None = None) -> FilmFile:
    """Begins a film, by the ending of its path.

    Args:
        path: ending in .webp, or .mp4 where an encoder is installed.
        size: width and height of its pictures.
        rate: [Hz] of pictures.
        sound: a WAV that begins with the first picture, for .mp4.

    Raises:
        EncodingError: there is no encoder.
    """
    return Mp4Film(path, size, rate=rate, sound=sound) if path.suffix.lower() == MP4 else WebpFilm(path, size)


def find_encoder() -> str | None:
    """Finds ffmpeg: that of the package imageio-ffmpeg, or the system's."""
    try:
        return str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        return shutil.which("ffmpeg")


class WebpFilm:
    """An animated WebP (RFC 9649). Each picture is what has changed since the one before; equal ones become one."""

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        *,
        quality: int = QUALITY,
        method: int = 0,
        in_parts: bool = True,
        once: bool = False,
    ) -> None:
        """Begins a file.

        Args:
            path: of the file.
            size: width and height of its pictures.
            quality: of the pictures, 0..100.
            method: of their compression, 0 fast to 6 small.
            in_parts: whether only what has changed is written; else every picture looks as it would alone.
            once: whether it stops at its last picture, instead of repeating for ever.
        """
        self._path, self._size, self._in_parts, self._loops = path, size, in_parts, int(once)
        self._encoded = partial(_webp, quality=quality, method=method)
        self._threads = ThreadPoolExecutor(THREADS)
        self._waiting: deque[tuple[Future[bytes], PixelBox, int]] = deque()
        self._last: tuple[Picture, PixelBox, int] | None = None

    def write(self, picture: Picture, changed: PixelBox | None, milliseconds: int, /) -> None:
        """Adds a picture."""
        if self._last is None:
            self._last = (picture, (0, 0, *self._size), milliseconds)
            return
        before, box, shown = self._last
        changed = _changed(before, picture, changed or (0, 0, *self._size))
        if changed is None:
            self._last = (before, box, shown + milliseconds)
            return
        self._encode(before, box, shown)
        self._last = (picture, changed if self._in_parts else (0, 0, *self._size), milliseconds)

    def _encode(self, picture: Picture, box: PixelBox, milliseconds: int) -> None:
        if len(self._waiting) >= WAITING:
            self._put(*self._waiting.popleft())
        part = np.ascontiguousarray(_cut(picture, box))
        self._waiting.append((self._threads.submit(self._encoded, part), box, milliseconds))

    def _put(self, encoded: Future[bytes], box: PixelBox, milliseconds: int) -> None:
        left, top, right, low = box
        place = b"".join(_little(value, 3) for value in (left // 2, top // 2, right - left - 1, low - top - 1))
        head = place + _little(milliseconds, 3) + bytes([WHOLE_PICTURE])
        self._file.write(_chunk(b"ANMF", head + encoded.result()))

    def __enter__(self) -> "WebpFilm":
        self._file: BinaryIO = self._path.open("wb")
        width, height = self._size
        canvas = bytes([0b10, 0, 0, 0]) + _little(width - 1, 3) + _little(height - 1, 3)
        self._file.write(
            b"RIFF\0\0\0\0WEBP" + _chunk(b"VP8X", canvas) + _chunk(b"ANIM", bytes(4) + _little(self._loops, 2))
        )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._file, self._threads:
            if error is not None:
                self._threads.shutdown(cancel_futures=True)
                self._path.unlink(missing_ok=True)  # nobody waits for the rest of it
                return
            if self._last is not None:
                self._encode(*self._last)
            while self._waiting:
                self._put(*self._waiting.popleft())
            size = self._file.tell() - 8
            self._file.seek(4)
            self._file.write(_little(size, 4))


class Mp4Film:
    """H.264 by an encoder that gets pictures as they come, with the sound beside them."""

    def __init__(self, path: Path, size: tuple[int, int], *, rate: float, sound: Path | None = None) -> None:
        """Finds the encoder.

        Raises:
            EncodingError: there is none.
        """
        encoder = find_encoder()
        if encoder is None:
            raise EncodingError(NO_ENCODER)
        pictures = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{rate:g}", "-i", "-"]
        heard = ["-i", str(sound), "-c:a", "aac"] if sound else []
        self._words = [encoder, "-y", "-loglevel", "error", *pictures, *heard, *ENCODING, str(path)]
        self._path = path

    def write(self, picture: Picture, changed: PixelBox | None, milliseconds: int, /) -> None:
        """Adds a picture; all are seen equally long."""
        try:
            self._pipe.write(picture.tobytes())
        except BrokenPipeError:
            raise EncodingError(f"{self._path}: {self._why()}") from None

    def __enter__(self) -> "Mp4Film":
        self._told = TemporaryFile()
        self._process = subprocess.Popen(
            self._words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._told
        )
        assert self._process.stdin is not None  # it is a pipe
        self._pipe = self._process.stdin
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._told:
            if error is not None:
                self._process.kill()
            try:
                self._pipe.close()
            except BrokenPipeError:
                self._process.kill()
            if self._process.wait() and error is None:
                raise EncodingError(f"{self._path}: {self._why()}")

    def _why(self) -> str:
        """The last thing that the encoder said."""
        self._process.wait()
        self._told.seek(0)
        lines = self._told.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else "the encoder ended"


def durations(count: int, rate: float) -> list[int]:
    """[ms] for which each of some pictures is seen, whole numbers that add up to their whole time."""
    return [int(value) for value in np.diff(np.round(1000 / rate * np.arange(count + 1)))]


def _webp(picture: Picture, *, quality: int, method: int) -> bytes:
    """The chunk of one picture, without the file's head."""
    held = BytesIO()
    Image.fromarray(picture).save(held, format="WEBP", quality=quality, method=method)
    return held.getvalue()[12:]


def _changed(before: Picture, after: Picture, within: PixelBox) -> PixelBox | None:
    """The least box that holds what has changed within one; left and top are even. None: nothing has."""
    left, top, _, _ = within
    differs = _cut(before, within) != _cut(after, within)
    flat = differs.reshape(len(differs), -1)
    rows, columns = np.flatnonzero(flat.any(axis=1)), np.flatnonzero(flat.any(axis=0)) // differs.shape[2]
    if not len(rows):
        return None
    begin = (left + int(columns[0]), top + int(rows[0]))
    return (begin[0] // 2 * 2, begin[1] // 2 * 2, left + int(columns[-1]) + 1, top + int(rows[-1]) + 1)


def _cut(picture: Picture, box: PixelBox) -> Picture:
    left, top, right, low = box
    return picture[top:low, left:right]


def _chunk(tag: bytes, data: bytes) -> bytes:
    return tag + _little(len(data), 4) + data + bytes(len(data) % 2)


def _little(value: int, count: int) -> bytes:
    return value.to_bytes(count, "little")
