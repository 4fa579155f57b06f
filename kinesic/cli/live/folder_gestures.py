"""Read gesture files from a folder into which clients may write.

Invalid files are skipped, and the number and total size of files are limited.
"""

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from kinesic.body.config import ConfigError, read_tables
from kinesic.expressivity.lexicon.lexicon import read_part
from kinesic.expressivity.lexicon.toml_file import LexiconPart

MAX_GESTURE_FILES = 500  # largest number of gesture files read per folder
MAX_GESTURE_BYTES = 1_000_000  # [bytes] largest total size of the gesture files read per folder


@dataclass(frozen=True, eq=False)
class FolderGestures:
    """Gestures of a folder, with an error message for each invalid file."""

    parts: tuple[LexiconPart, ...]
    faults: tuple[str, ...]  # one message per skipped gesture file


def read_folder(folder: Path) -> FolderGestures:
    """Read at most `MAX_GESTURE_FILES` gesture files (TOML) of a folder.

    Links are ignored. Files are read in order of name.
    """
    parts, faults, remaining_bytes = list[LexiconPart](), list[str](), MAX_GESTURE_BYTES
    for path in sorted(islice(folder.glob("*.toml"), MAX_GESTURE_FILES)):
        try:
            if path.is_symlink() or not path.is_file():
                continue
            if (size := path.stat().st_size) > remaining_bytes:
                faults.append(
                    f"{path}: at most {MAX_GESTURE_BYTES // 1_000_000} MB of gestures are read; move some elsewhere"
                )
            elif read_tables(path).get("gesture"):
                parts.append(read_part(path))
                remaining_bytes -= size
        except (ConfigError, OSError) as error:
            faults.append(str(error))
    return FolderGestures(tuple(parts), tuple(faults))
