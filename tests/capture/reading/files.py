"""Reading of motion files in tests."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from kinesic.capture.reading.text import read_file

Result = TypeVar("Result")


def load(read: Callable[[bytes, str], Result], path: Path) -> Result:
    """Read a motion file with one of the readers."""
    return read(read_file(path), str(path))
