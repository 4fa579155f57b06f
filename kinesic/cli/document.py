"""The document that a verb is given."""

import sys
from pathlib import Path

from kinesic.bml.block import BmlError


def read_document(file: str) -> bytes:
    """The bytes of a file, or of standard input for `-`.

    Raises:
        BmlError: there is no such file, or it cannot be read.
    """
    if file == "-":
        return sys.stdin.buffer.read()
    try:
        return Path(file).read_bytes()
    except OSError as error:
        raise BmlError(f"{file}: {error.strerror}") from None
