"""Size-limited reading and parsing of motion files, with located errors."""

from array import array
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np

from kinesic.body.arrays import Floats, seal_in_place
from kinesic.body.config import ConfigError
from kinesic.files.input_file import open_regular

MAX_FILE_SIZE = 64_000_000  # [bytes] largest motion file that is read
MAX_FRAMES = 200_000  # largest number of frames of a clip
MAX_LINES = 2_000_000  # largest number of lines of a text file
MAX_LINE_LENGTH = 1_000_000  # [characters] longest line of a text file
MAX_NUMBER = 1e12  # largest absolute value of a number, whose square and cube are finite
MAX_JOINTS = 1000  # largest number of joints of a skeleton


class CaptureError(ConfigError):
    """Error in a motion file, located by file and place."""


def read_file(path: Path) -> bytes:
    """Read the bytes of a motion file of limited size.

    Raises:
        CaptureError: the file is missing, too large, or no regular file.
    """
    with _open(path) as file:
        data = file.read(MAX_FILE_SIZE + 1)
    check_size(data, str(path))
    return data


def check_regular(path: Path) -> None:
    """Raise an error unless a path is a regular file.

    Raises:
        CaptureError: the file is missing, or a folder, a pipe or a device.
    """
    with _open(path):
        pass


@contextmanager
def _open(path: Path) -> Iterator[BinaryIO]:
    try:
        with open_regular(path) as file:
            yield file
    except OSError as error:
        raise CaptureError(f"{path}: {error.strerror}") from None
    except ConfigError as error:
        raise CaptureError(str(error)) from None


def check_size(data: bytes, source: str) -> None:
    """Raise an error if a motion file is too large.

    Raises:
        CaptureError: it has more than `MAX_FILE_SIZE` bytes.
    """
    if len(data) > MAX_FILE_SIZE:
        raise CaptureError(f"{source}: more than {MAX_FILE_SIZE // 1_000_000} MB")


def decode(data: bytes, source: str) -> str:
    """Decode a motion file as UTF-8, replacing invalid bytes.

    Raises:
        CaptureError: the file is too large.
    """
    check_size(data, source)
    return data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n")


def split_lines(data: bytes, source: str) -> list[str]:
    """Decode a motion file into lines of limited number and length.

    Raises:
        CaptureError: the file is too large, or has too many or too long lines.
    """
    if data.count(b"\n") > MAX_LINES:
        raise CaptureError(f"{source}: more than {MAX_LINES} lines")
    lines = decode(data, source).split("\n")
    if max(map(len, lines)) > MAX_LINE_LENGTH:
        raise CaptureError(f"{source}: a line has more than {MAX_LINE_LENGTH} characters")
    return lines


def parse_numbers(words: Iterable[str], place: str) -> Floats:
    """Parse words as finite numbers (k,).

    Raises:
        CaptureError: a word is no finite number; the message begins with the place.
    """
    try:
        numbers = array("d", map(float, words))
    except (ValueError, OverflowError) as error:
        raise CaptureError(f"{place}: {error}") from None
    return check_numbers(seal_in_place(np.frombuffer(numbers)), place)


def check_numbers(numbers: Floats, place: str) -> Floats:
    """Return the numbers, checked to be finite and of moderate size.

    Raises:
        CaptureError: a number is NaN, or beyond `MAX_NUMBER`; the message begins with the place.
    """
    largest = float(np.abs(numbers).max(initial=0.0))
    if not np.isfinite(largest):
        raise CaptureError(f"{place}: a number is not finite")
    if largest > MAX_NUMBER:
        raise CaptureError(f"{place}: a number has the size {largest:.3g}; at most {MAX_NUMBER:g} is read")
    return numbers


def parse_count(word: str, place: str, *, most: int) -> int:
    """Parse a word as a count from 0 to a maximum.

    Raises:
        CaptureError: the word is no such count.
    """
    try:
        count = int(word)
    except ValueError:
        raise CaptureError(f"{place}: {word[:20]!r} must be a whole number") from None
    if not 0 <= count <= most:
        raise CaptureError(f"{place}: {count} must be from 0 to {most}")
    return count


def check_times(times: Floats, source: str) -> None:
    """Raise an error unless 2 to `MAX_FRAMES` times increase strictly.

    Raises:
        CaptureError: fewer than two frames, more than `MAX_FRAMES`, or times that do not increase.
    """
    if not 2 <= len(times) <= MAX_FRAMES:
        raise CaptureError(f"{source}: it has {len(times)} frames; it needs from 2 to {MAX_FRAMES}")
    backward = np.flatnonzero(np.diff(times) <= 0.0)
    if backward.size:
        frame = int(backward[0]) + 2
        raise CaptureError(f"{source}: its frames are not in order of time (frame {frame})")
