"""Reader of Greta's XML settings and their numbers."""

from math import isfinite
from pathlib import Path

from kinesic.bml.block import BmlError
from kinesic.bml.reading.tree import Element, read_tree
from kinesic.body.config import ConfigError


def read_root(path: Path, name: str) -> Element:
    """Read an XML file and check the name of its root element.

    Raises:
        ConfigError: the file is missing, is not XML, or has another root.
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


def number_of(element: Element, name: str, path: Path, default: float) -> float:
    """Return a numeric attribute of an element, or the default.

    Raises:
        ConfigError: the value is not a finite number.
    """
    return default if name not in element.attributes else read_number(element.attributes[name], element, path)


def read_number(text: str, element: Element, path: Path) -> float:
    """Parse a finite number.

    Raises:
        ConfigError: the text is not a finite number.
    """
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not isfinite(number):
        raise ConfigError(f"{path}:{element.place.line}: {text!r} in <{element.name}> is no number")
    return number
