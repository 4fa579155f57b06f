"""Files that other files name: whoever sends somebody a folder names nothing outside of it."""

from pathlib import Path

from kinesic.body.config import ConfigError


def check_inside(folder: Path, named: Path) -> None:
    """Refuses a file outside of a folder, by its path or through links, and what is there but no ordinary file.

    Args:
        folder: of the file that names the other one.
        named: path of the other one; where nothing is there, whoever reads it says so.

    Raises:
        ConfigError: it is one of these.
    """
    try:
        place, home = named.resolve(), folder.resolve()
        is_odd = place.exists() and not place.is_file()  # whoever opens a pipe may wait for ever
    except (OSError, RuntimeError, ValueError) as error:  # a ring of links, no name of a file
        raise ConfigError(f"{str(named)!r} names no file: {error}") from None
    if not place.is_relative_to(home):
        raise ConfigError(f"{str(named)!r} is outside of the folder {folder}; copy that file there, and name it alone")
    if is_odd:
        raise ConfigError(f"{str(named)!r} is no ordinary file; name one")
