"""Reads the XML of Greta's settings, and the numbers in it."""

from math import isfinite
from pathlib import Path

from kinesic.bml.block import BmlError
from kinesic.bml.reading.tree import Element, read_tree
from kinesic.body.config import ConfigError


def read_root(path: Path, name: str) -> Element:
    """Reads a file whose outermost element has a name.

    Raises:
        ConfigError: there is no such file, it is no XML, or something else.
    """
    try:
        root = read_tree(path.read_bytes(), source=str(path))
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except BmlError as error:
        raise ConfigError(str(error)) from None
    if root.local != name:
        raise ConfigError(f"{path}: <{root.name}> where <{name}> is expected")
    return root


def number_of(element: Element, name: str, path: Path, usual: float) -> float:
    """Reads a number of an element; where it does not say, the usual one.

    Raises:
        ConfigError: it is no finite number.
    """
    return usual if name not in element.attributes else read_number(element.attributes[name], element, path)


def read_number(written: str, element: Element, path: Path) -> float:
    """Reads a finite number.

    Raises:
        ConfigError: it is none.
    """
    try:
        number = float(written)
    except ValueError:
        number = float("nan")
    if not isfinite(number):
        raise ConfigError(f"{path}:{element.place.line}: {written!r} in <{element.name}> is no number")
    return number
