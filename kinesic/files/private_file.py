"""Reading of secrets from files that no other user can read."""

import os
import stat
from pathlib import Path

from kinesic.body.config import ConfigError

MAX_SECRET_BYTES = 4096  # [bytes] longest accepted first line of a secret's file


def check_private(path: Path, option: str) -> None:
    """Raise an error if other users can read a secret's file.

    Args:
        path: path of the secret's file.
        option: command-line option, for messages.

    Raises:
        ConfigError: other users can read the file, or it cannot be examined.
    """
    try:
        mode = path.stat().st_mode
    except OSError as error:
        raise ConfigError(f"{option} {path}: {error.strerror}") from None
    _refuse_shared(mode, f"{option} {path}")


def read_secret(path: Path, option: str) -> str:
    """Return the first line of a private file.

    Args:
        path: path of a file or a pipe.
        option: command-line option, for messages.

    Raises:
        ConfigError: other users can read the file, or it has no line of text.
    """
    place = f"{option} {path}"
    try:
        with path.open("rb") as file:
            _refuse_shared(os.fstat(file.fileno()).st_mode, place)  # of the very file that is read
            line = file.readline(MAX_SECRET_BYTES + 1)
        text = line.decode().strip()
    except OSError as error:
        raise ConfigError(f"{place}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ConfigError(f"{place}: its first line is not text in UTF-8") from None
    if not text or len(line) > MAX_SECRET_BYTES:
        raise ConfigError(f"{place}: its first line must hold 1 to {MAX_SECRET_BYTES} bytes")
    return text


def _refuse_shared(mode: int, place: str) -> None:
    if os.name == "posix" and mode & (stat.S_IRGRP | stat.S_IROTH):
        raise ConfigError(f"{place}: other users can read it (mode {stat.S_IMODE(mode):03o}); chmod 600 it")
