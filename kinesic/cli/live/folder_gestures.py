"""Reads the gestures of a folder that others may write to: what is wrong is passed over, and what is much is, too."""

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from kinesic.body.config import ConfigError, read_tables
from kinesic.expressivity.lexicon.lexicon import read_part
from kinesic.expressivity.lexicon.toml_file import LexiconPart

MOST_FILES = 500  # that are looked at
MOST_BYTES = 1_000_000  # of all that are read


@dataclass(frozen=True, eq=False)
class FolderGestures:
    """What the files of a folder say, and what is wrong with the others."""

    parts: tuple[LexiconPart, ...]
    faults: tuple[str, ...]  # one for each file of gestures that is passed over


def read_folder(folder: Path) -> FolderGestures:
    """Reads all TOML files of a folder that hold gestures, in the order of their names; links are none."""
    parts, faults, left = list[LexiconPart](), list[str](), MOST_BYTES
    for path in sorted(islice(folder.glob("*.toml"), MOST_FILES)):
        try:
            if path.is_symlink() or not path.is_file():
                continue
            if (size := path.stat().st_size) > left:
                faults.append(f"{path}: at most {MOST_BYTES // 1_000_000} MB of gestures are read; move some elsewhere")
            elif read_tables(path).get("gesture"):
                parts.append(read_part(path))
                left -= size
        except (ConfigError, OSError) as error:
            faults.append(str(error))
    return FolderGestures(tuple(parts), tuple(faults))
