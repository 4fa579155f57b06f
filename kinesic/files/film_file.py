"""Incremental writing of films as animated WebP or H.264.

H.264 needs an installed encoder. The length of a film is unlimited.
"""

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

from kinesic.body.arrays import Picture
from kinesic.extras import install_command
from kinesic.files.late_pillow import Image

PixelBox = tuple[int, int, int, int]  # left, top, right, bottom [pixels]; left and top are even

WEBP_SUFFIX = ".webp"  # suffix of animated WebP films
MP4_SUFFIX = ".mp4"  # suffix of H.264 films
H264_OPTIONS = (  # ffmpeg options that all players support; width and height must be even
    *("-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p"),
    *("-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv"),
    *("-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"),
    *("-movflags", "+faststart"),  # lets a browser start before the download ends
)
WEBP_QUALITY = 80  # Picture quality, 0..100
ENCODER_THREADS = 2  # number of threads that encode WebP pictures
MAX_PENDING_PICTURES = 6  # largest number of WebP pictures queued for encoding
REPLACE_FLAG = 0b10  # WebP frame flag: replace pixels instead of blending with them


class EncodingError(RuntimeError):
    """Failure to encode a film, with its reason and remedy."""


class FilmFile(Protocol):
    """Interface for writing a film picture by picture.

    As a context manager it completes its file, unless an error occurs.
    """

    def write(self, picture: Picture, changed: PixelBox | None, milliseconds: int, /) -> None:
        """Add a picture to the film, shown for a duration [ms].

        It differs from the last one only in the box `changed` (None: anywhere).
        """

    def __enter__(self) -> Self:
        """Create the film file."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Complete the film file, or abandon it after an error."""


def open_film(path: Path, size: tuple[int, int], *, rate: float, sound: Path | None = None) -> FilmFile:
    """Create a film in the format of the path's suffix.

    Args:
        path: path ending in .webp, or .mp4 if an encoder is installed.
        size: width and height of the pictures.
        rate: [Hz] picture rate.
        sound: WAV file that begins with the first picture, for .mp4.

    Raises:
        EncodingError: no encoder is installed.
    """
    return Mp4Film(path, size, rate=rate, sound=sound) if path.suffix.lower() == MP4_SUFFIX else WebpFilm(path, size)


def explain_missing_encoder() -> str:
    """Return an error line with the commands that install an MP4 encoder."""
    package = f"{install_command()} imageio-ffmpeg"
    return f"no encoder for .mp4: {package}, or install ffmpeg; .webp needs none"


def find_encoder() -> str | None:
    """Return the path of ffmpeg (imageio-ffmpeg or system), or None."""
    try:
        return str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        return shutil.which("ffmpeg")


class WebpFilm:
    """Writer of animated WebP films (RFC 9649).

    By default only changed regions are stored. Equal successive pictures are merged.
    """

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        *,
        quality: int = WEBP_QUALITY,
        method: int = 0,
        in_parts: bool = True,
        once: bool = False,
    ) -> None:
        """Set the path and picture size of the film.

        Args:
            path: path of the file.
            size: width and height of the pictures.
            quality: picture quality, 0..100.
            method: compression effort, 0 fast to 6 small.
            in_parts: whether only changed regions are written; otherwise every picture looks as it would alone.
            once: whether playback stops at the last picture instead of repeating for ever.
        """
        self._path, self._size, self._in_parts, self._loops = path, size, in_parts, int(once)
        self._encoded = partial(_encode_webp, quality=quality, method=method)
        self._threads = ThreadPoolExecutor(ENCODER_THREADS)
        self._waiting: deque[tuple[Future[bytes], PixelBox, int]] = deque()
        self._last: tuple[Picture, PixelBox, int] | None = None

    def write(self, picture: Picture, changed: PixelBox | None, milliseconds: int, /) -> None:
        """Add a picture to the WebP film, shown for a duration [ms]."""
        if self._last is None:
            self._last = (picture, (0, 0, *self._size), milliseconds)
            return
        before, box, shown = self._last
        changed = _find_changed_box(before, picture, changed or (0, 0, *self._size))
        if changed is None:
            self._last = (before, box, shown + milliseconds)
            return
        self._encode(before, box, shown)
        self._last = (picture, changed if self._in_parts else (0, 0, *self._size), milliseconds)

    def _encode(self, picture: Picture, box: PixelBox, milliseconds: int) -> None:
        if len(self._waiting) >= MAX_PENDING_PICTURES:
            self._put(*self._waiting.popleft())
        part = np.ascontiguousarray(_cut(picture, box))
        self._waiting.append((self._threads.submit(self._encoded, part), box, milliseconds))

    def _put(self, encoded: Future[bytes], box: PixelBox, milliseconds: int) -> None:
        left, top, right, low = box
        place = b"".join(_little(value, 3) for value in (left // 2, top // 2, right - left - 1, low - top - 1))
        head = place + _little(milliseconds, 3) + bytes([REPLACE_FLAG])
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
                self._path.unlink(missing_ok=True)  # tells readers that no more pictures will come
                return
            if self._last is not None:
                self._encode(*self._last)
            while self._waiting:
                self._put(*self._waiting.popleft())
            size = self._file.tell() - 8
            self._file.seek(4)
            self._file.write(_little(size, 4))


class Mp4Film:
    """Writer of H.264 films through ffmpeg, with optional sound."""

    def __init__(self, path: Path, size: tuple[int, int], *, rate: float, sound: Path | None = None) -> None:
        """Find the encoder and prepare its command.

        Raises:
            EncodingError: no encoder is installed.
        """
        encoder = find_encoder()
        if encoder is None:
            raise EncodingError(explain_missing_encoder())
        pictures = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{rate:g}", "-i", "-"]
        sound_options = ["-i", str(sound), "-c:a", "aac"] if sound else []
        self._command = [encoder, "-y", "-loglevel", "error", *pictures, *sound_options, *H264_OPTIONS, str(path)]
        self._path = path

    def write(self, picture: Picture, changed: PixelBox | None, milliseconds: int, /) -> None:
        """Add a picture to the H.264 film, shown for one picture period."""
        try:
            self._pipe.write(picture.tobytes())
        except BrokenPipeError:
            raise EncodingError(f"{self._path}: {self._read_encoder_error()}") from None

    def __enter__(self) -> "Mp4Film":
        self._errors = TemporaryFile()
        self._process = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._errors
        )
        assert self._process.stdin is not None  # standard input is a pipe
        self._pipe = self._process.stdin
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._errors:
            if error is not None:
                self._process.kill()
            try:
                self._pipe.close()
            except BrokenPipeError:
                self._process.kill()
            if self._process.wait() and error is None:
                raise EncodingError(f"{self._path}: {self._read_encoder_error()}")

    def _read_encoder_error(self) -> str:
        """Wait for the encoder to end and return its last message."""
        self._process.wait()
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else "the encoder ended"


def picture_durations(count: int, rate: float) -> list[int]:
    """Compute `count` integer picture durations [ms] for a picture rate [Hz]."""
    return [int(value) for value in np.diff(np.round(1000 / rate * np.arange(count + 1)))]


def _encode_webp(picture: Picture, *, quality: int, method: int) -> bytes:
    """Encode one picture as WebP without the 12-byte file header."""
    held = BytesIO()
    Image.fromarray(picture).save(held, format="WEBP", quality=quality, method=method)
    return held.getvalue()[12:]


def _find_changed_box(before: Picture, after: Picture, within: PixelBox) -> PixelBox | None:
    """Return the smallest box of changed pixels within a box, or None.

    Its left and top are even.
    """
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
