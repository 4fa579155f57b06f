"""Pictures and short films of the face in files."""

from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from kinesic.face.display import DisplayError
from kinesic.face.portrait import Pixels

STILLS = (".png", ".webp")
FILM = ".webp"
QUALITY = 88


def save(pixels: Pixels, path: Path) -> None:
    """Writes one picture, PNG or WebP by its ending.

    Raises:
        DisplayError: another ending, or the file cannot be written.
    """
    check_ending(path)
    try:
        Image.fromarray(pixels).save(path, quality=QUALITY)
    except OSError as error:
        raise DisplayError(f"{path}: {error.strerror or error}") from None


def save_film(frames: Sequence[Pixels], path: Path, *, rate: float, once: bool = False) -> None:
    """Writes an animated WebP.

    Args:
        frames: in their order, at least one.
        path: ending in .webp.
        rate: [Hz] of frames.
        once: whether it stops at its last frame, instead of repeating for ever.

    Raises:
        DisplayError: another ending, or the file cannot be written.
    """
    if path.suffix.lower() != FILM:
        raise DisplayError(f"{path}: a film of the face ends in {FILM}")
    first, *others = (Image.fromarray(frame) for frame in frames)
    try:
        first.save(
            path,
            save_all=True,
            append_images=others,
            duration=round(1e3 / rate),
            loop=1 if once else 0,
            quality=QUALITY,
            method=2,
        )
    except OSError as error:
        raise DisplayError(f"{path}: {error.strerror or error}") from None


def check_ending(path: Path) -> None:
    """Refuses a path whose ending names no format of pictures.

    Raises:
        DisplayError: it does not.
    """
    if path.suffix.lower() not in STILLS:
        raise DisplayError(f"{path}: a picture of the face ends in {' or '.join(STILLS)}")
