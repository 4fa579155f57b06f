"""Pictures and short films of the face in files, and films of the body that are shown beside it."""

import shutil
import subprocess
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from kinesic.face.display import DisplayError
from kinesic.face.render.portrait import Pixels

STILLS = (".png", ".webp")
FILM = ".webp"
STRIP, ENCODED = ".png", ".mp4"
FILMS = (FILM, ENCODED, STRIP)
QUALITY = 88
STRIP_WIDTH = 2048  # pixels, about
ENCODING = (  # what every player plays; it wants even sides
    *("-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p"),
    *("-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"),
)
NO_ENCODER = "no encoder for .mp4: pip install imageio-ffmpeg, or apt-get install ffmpeg; .webp needs none"


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


def save_film(
    frames: Sequence[Pixels], path: Path, *, rate: float, once: bool = False, sound: Path | None = None
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
    match path.suffix.lower():
        case ".png":
            save(film_strip(frames), path)
        case ".mp4":
            _encode(frames, path, rate, sound)
        case _:
            _animate(frames, path, rate, once=once)


def film_strip(frames: Sequence[Pixels]) -> Pixels:
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
    """Finds ffmpeg: that of the package imageio-ffmpeg, or the system's.

    Raises:
        DisplayError: there is none.
    """
    try:
        return str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        found = shutil.which("ffmpeg")
    if found is None:
        raise DisplayError(NO_ENCODER)
    return found


def _animate(frames: Sequence[Pixels], path: Path, rate: float, *, once: bool) -> None:
    first, *others = (Image.fromarray(frame) for frame in frames)
    durations = np.diff(np.round(1e3 * np.arange(len(frames) + 1) / rate)).astype(int).tolist()  # [ms]
    loop = 1 if once else 0
    try:
        first.save(path, save_all=True, append_images=others, duration=durations, loop=loop, quality=QUALITY, method=2)
    except OSError as error:
        raise DisplayError(f"{path}: {error.strerror or error}") from None


def _encode(frames: Sequence[Pixels], path: Path, rate: float, sound: Path | None) -> None:
    height, width, _ = frames[0].shape
    pictures = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{rate:g}", "-i", "-"]
    heard = ["-i", str(sound), "-c:a", "aac"] if sound else []
    words = [encoder(), "-y", "-loglevel", "error", *pictures, *heard, *ENCODING, str(path)]
    ended = subprocess.run(words, input=b"".join(frame.tobytes() for frame in frames), capture_output=True, check=False)
    if ended.returncode:
        last = (ended.stderr.decode(errors="replace").strip().splitlines() or ["ffmpeg failed"])[-1]
        raise DisplayError(f"{path}: {last}")


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
