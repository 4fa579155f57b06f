"""Pictures and short films of the face in files, and films of the body that are shown beside it."""

from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from PIL import Image

from kinesic.body.arrays import Picture
from kinesic.face.display import DisplayError
from kinesic.files.film_file import MP4 as ENCODED
from kinesic.files.film_file import NO_ENCODER, EncodingError, Mp4Film, WebpFilm, find_encoder
from kinesic.files.film_file import WEBP as FILM
from kinesic.files.film_reader import FilmReader

STILLS = (".png", ".webp")
STRIP = ".png"
FILMS = (FILM, ENCODED, STRIP)
QUALITY, METHOD = 86, 1  # of WebP: 2 takes three times as long for a seventh less
STRIP_WIDTH = 2048  # pixels, about


def save(pixels: Picture, path: Path) -> None:
    """Writes one picture, PNG or WebP by its ending.

    Raises:
        DisplayError: another ending, or the file cannot be written.
    """
    check_ending(path)
    try:
        Image.fromarray(pixels).save(path, quality=QUALITY)
    except OSError as error:
        raise DisplayError(f"{path}: {error.strerror or error}") from None


def save_film(
    frames: Iterable[Picture], path: Path, *, rate: float, once: bool = False, sound: Path | None = None
) -> None:
    """Writes a film by its ending: an animated WebP, an MP4, or as PNG all its pictures in rows.

    Args:
        frames: in their order, at least one.
        path: ending in .webp, .mp4 or .png.
        rate: [Hz] of frames.
        once: whether it stops at its last frame, instead of repeating for ever.
        sound: a WAV that begins with the first frame, for .mp4.

    Raises:
        DisplayError: another ending, no encoder, or the file cannot be written.
    """
    check_film(path)
    if path.suffix.lower() == STRIP:
        save(film_strip(list(frames)), path)
        return
    others = iter(frames)
    first = next(others)
    size = (first.shape[1], first.shape[0])
    try:
        with (
            WebpFilm(path, size, quality=QUALITY, method=METHOD, in_parts=False, once=once)
            if path.suffix.lower() == FILM
            else Mp4Film(path, size, rate=rate, sound=sound)
        ) as film:
            for k, frame in enumerate(chain((first,), others)):
                film.write(frame, None, round(1e3 * (k + 1) / rate) - round(1e3 * k / rate))
    except EncodingError as error:
        raise DisplayError(str(error)) from None
    except OSError as error:
        raise DisplayError(f"{path}: {error.strerror or error}") from None


def film_strip(frames: Sequence[Picture]) -> Picture:
    """Puts frames in rows, the first on the left of the uppermost."""
    height, width, depth = frames[0].shape
    across = max(1, min(len(frames), STRIP_WIDTH // width))
    rows = -(-len(frames) // across)
    paper = np.zeros((rows * height, across * width, depth), dtype=np.uint8)
    for place, frame in enumerate(frames):
        top, left = place // across * height, place % across * width
        paper[top : top + height, left : left + width] = frame
    return paper


def check_ending(path: Path) -> None:
    """Refuses a path whose ending names no format of pictures.

    Raises:
        DisplayError: it does not.
    """
    if path.suffix.lower() not in STILLS:
        raise DisplayError(f"{path}: a picture of the face ends in {' or '.join(STILLS)}")


def check_film(path: Path) -> None:
    """Refuses a path whose ending names no format of films, or one that cannot be written here.

    Raises:
        DisplayError: it does not, or there is no encoder.
    """
    if path.suffix.lower() not in FILMS:
        raise DisplayError(f"{path}: a film of the face ends in {', '.join(FILMS)}")
    if path.suffix.lower() == ENCODED:
        encoder()


def encoder() -> str:
    """Finds ffmpeg.

    Raises:
        DisplayError: there is none.
    """
    found = find_encoder()
    if found is None:
        raise DisplayError(NO_ENCODER)
    return found


class SideFilm:
    """An animated picture of the body that is read as time goes on; only one of its pictures is in memory."""

    def __init__(self, path: Path, height: int) -> None:
        """Opens a film.

        Args:
            path: of an animated WebP on the clock of the performance.
            height: of its pictures as they are shown [pixels].

        Raises:
            DisplayError: it cannot be read.
        """
        try:
            self._film = FilmReader(path)
        except OSError as error:
            raise DisplayError(f"{path}: no film: {error}") from None
        width, tall = self._film.size
        self._size = (round(width * height / tall), height)

    def at(self, time: float) -> Picture:
        """(height, width, 3) the picture of a time [s]; times never decrease."""
        return np.asarray(Image.fromarray(self._film.at(time)).resize(self._size))
