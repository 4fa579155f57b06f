"""Folders for what is written: each of its own, never on top of another."""

import shutil
from datetime import datetime
from pathlib import Path

from kinesic.body.config import ConfigError


def free_folder(asked: Path | None, source: str, *, force: bool = False) -> Path:
    """The folder `asked`, or `out/NAME-TIME`; it is made when something is written.

    Raises:
        ConfigError: it exists already and `force` is not given.
    """
    folder = asked or Path("out") / f"{Path(source).stem or 'stdin'}-{datetime.now():%Y%m%d-%H%M%S}"
    if folder.exists() and not force:
        raise ConfigError(f"{folder} exists already; --force replaces it, --out names another")
    return folder


def emptied(folder: Path) -> Path:
    """Makes a folder, and removes what was there before."""
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    return folder
