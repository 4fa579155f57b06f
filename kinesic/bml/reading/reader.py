"""State of a document that is being read, and readers for numbers."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kinesic.bml.block import BmlError, Dialect, Notice, NoticeType, Place, document_error
from kinesic.bml.reading.tree import Element

MAX_NUMBER = 1e4  # largest absolute value of a number, except in sync references


@dataclass(frozen=True)
class DocumentReading:
    """State of reading a document, with the notices collected until now."""

    source: str
    block: str
    dialect: Dialect
    home: str | None  # namespace of the <bml>
    recordings: Path | None = None  # folder of the recordings of a document without a file; None: no sound
    notices: list[Notice] = field(default_factory=list)

    def error(self, place: Place, problem: str, remedy: str) -> BmlError:
        """Return the error that rejects the document."""
        return document_error(self.source, place, problem, remedy)

    def add_notice(self, kind: NoticeType, text: str, *, behaviour: str | None = None) -> None:
        """Add a notice about the block or one of its behaviours."""
        self.notices.append(Notice(kind, self.block if behaviour is None else f"{self.block}:{behaviour}", text))


@dataclass(frozen=True)
class BehaviourElement:
    """Behaviour element with its id and attributes by local name."""

    id: str
    element: Element
    attributes: Mapping[str, str]

    def attribute(self, *names: str, default: str = "") -> str:
        """Return the stripped value of the first attribute found, or the default."""
        values = (self.attributes[name].strip() for name in names if name in self.attributes)
        return next(values, default)


def read_number(named: BehaviourElement, name: str, reading: DocumentReading, *, default: float) -> float:
    """Read an attribute as a finite number, or return the default.

    Raises:
        BmlError: not a number, not finite, or beyond `MAX_NUMBER`.
    """
    text = named.attribute(name)
    return read_finite(text, name, named.element.place, reading) if text else default


def read_integer(named: BehaviourElement, name: str, reading: DocumentReading, *, default: int, largest: int) -> int:
    """Read an attribute as a positive integer, or return the default.

    Raises:
        BmlError: not an integer, or outside 1 to `largest`.
    """
    value = read_number(named, name, reading, default=default)
    if value != int(value) or not 1 <= value <= largest:
        problem = f"{name}='{named.attribute(name)}' is not an integer from 1 to {largest}"
        raise reading.error(named.element.place, problem, f"for example {name}='{default}'")
    return int(value)


def read_finite(text: str, name: str, place: Place, reading: DocumentReading) -> float:
    """Convert a text to a finite number.

    Raises:
        BmlError: not a number, not finite, or beyond `MAX_NUMBER`.
    """
    try:
        value = float(text)
    except ValueError:
        raise reading.error(place, f"{name}='{text}' is not a number", f"for example {name}='0.5'") from None
    if not math.isfinite(value) or abs(value) > MAX_NUMBER:
        raise reading.error(place, f"{name}='{text}' is out of range", f"use a finite number up to {MAX_NUMBER:g}")
    return value
