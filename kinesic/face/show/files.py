"""Picture and film files of the face, and accompanying body films."""

from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.face.display import DisplayError
from kinesic.files.film_file import MP4_SUFFIX as ENCODED
from kinesic.files.film_file import WEBP_SUFFIX as FILM
from kinesic.files.film_file import EncodingError, Mp4Film, WebpFilm, explain_missing_encoder, find_encoder
from kinesic.files.film_reader import FilmReader
from kinesic.files.late_pillow import Image

PICTURE_SUFFIXES = (".png", ".webp")  # formats of single pictures
STRIP_SUFFIX = ".png"  # suffix of a picture with all film frames in rows
FILM_SUFFIXES = (FILM, ENCODED, STRIP_SUFFIX)
WEBP_QUALITY = 86  # picture quality, 0..100
WEBP_METHOD = 1  # compression effort; 2 takes three times as long for files one seventh smaller
MAX_STRIP_WIDTH = 2048  # [pixels] largest width of a picture of film frames in rows


def save_picture(pixels: Picture, path: Path) -> None:
    """Write one picture as PNG or WebP by its suffix.

    Raises:
        DisplayError: another suffix, or the file cannot be written.
    """
    check_ending(path)
    try:
        Image.fromarray(pixels).save(path, quality=WEBP_QUALITY)
    except OSError as error:
        raise DisplayError(f"{path}: {error.strerror or error}") from None


def save_film(
    frames: Iterable[Picture], path: Path, *, rate: float, once: bool = False, sound: Path | None = None
) -> None:
    """Write a film as WebP, MP4 or PNG strip by its suffix.

    Args:
        frames: pictures in order, at least one.
        path: file ending in .webp, .mp4 or .png.
        rate: frame rate [Hz].
        once: whether the film stops at its last frame instead of repeating.
        sound: WAV file that starts with the first frame, for .mp4.

    Raises:
        DisplayError: another suffix, no encoder, or the file cannot be written.
    """
    check_film(path)
    if path.suffix.lower() == STRIP_SUFFIX:
        save_picture(join_frames(list(frames)), path)
        return
    remaining = iter(frames)
    first = next(remaining)
    size = (first.shape[1], first.shape[0])
    try:
        with (
            WebpFilm(path, size, quality=WEBP_QUALITY, method=WEBP_METHOD, in_parts=False, once=once)
            if path.suffix.lower() == FILM
            else Mp4Film(path, size, rate=rate, sound=sound)
        ) as film:
            for k, frame in enumerate(chain((first,), remaining)):
                film.write(frame, None, round(1e3 * (k + 1) / rate) - round(1e3 * k / rate))
    except EncodingError as error:
        raise DisplayError(str(error)) from None
    except OSError as error:
        raise DisplayError(f"{path}: {error.strerror or error}") from None


def join_frames(frames: Sequence[Picture]) -> Picture:
    """Arrange film frames in rows, from the top left."""
    height, width, depth = frames[0].shape
    across = max(1, min(len(frames), MAX_STRIP_WIDTH // width))
    rows = -(-len(frames) // across)
    paper = np.zeros((rows * height, across * width, depth), dtype=np.uint8)
    for place, frame in enumerate(frames):
        top, left = place // across * height, place % across * width
        paper[top : top + height, left : left + width] = frame
    return paper


def check_ending(path: Path) -> None:
    """Reject a picture path without a picture suffix.

    Raises:
        DisplayError: the suffix is not that of a picture.
    """
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        raise DisplayError(f"{path}: a picture of the face must end in {' or '.join(PICTURE_SUFFIXES)}")


def check_film(path: Path) -> None:
    """Reject a film path with wrong suffix or without an encoder.

    Raises:
        DisplayError: the suffix is not that of a film, or there is no encoder.
    """
    if path.suffix.lower() not in FILM_SUFFIXES:
        raise DisplayError(f"{path}: a film of the face must end in {', '.join(FILM_SUFFIXES)}")
    if path.suffix.lower() == ENCODED:
        require_encoder()


def require_encoder() -> str:
    """Return the path of ffmpeg, which encodes films.

    Raises:
        DisplayError: ffmpeg is not installed.
    """
    path = find_encoder()
    if path is None:
        raise DisplayError(explain_missing_encoder())
    return path


class SideFilm:
    """Film of the body that is read picture by picture."""

    def __init__(self, path: Path, height: int) -> None:
        """Open an accompanying film of the body.

        Args:
            path: animated WebP on the clock of the performance.
            height: height of the displayed pictures [pixels].

        Raises:
            DisplayError: the file cannot be read.
        """
        try:
            self._film = FilmReader(path)
        except OSError as error:
            raise DisplayError(f"{path}: not a film: {error}") from None
        width, tall = self._film.size
        self._size = (round(width * height / tall), height)

    def at(self, time: float) -> Picture:
        """Return the body film's picture at a time [s].

        Times must not decrease between calls.
        """
        return np.asarray(Image.fromarray(self._film.at(time)).resize(self._size))
