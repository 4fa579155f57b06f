"""What the functions that read one document share: its name, how to refuse, notices so far, numbers."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from kinesic.bml.block import BmlError, Dialect, Notice, NoticeType, Place, refusal
from kinesic.bml.reading.tree import Element

LARGEST_NUMBER = 1e4  # no number of BML but a time, which has its own limit, is larger


@dataclass(frozen=True)
class DocumentReading:
    """One document while it is read."""

    source: str
    block: str
    dialect: Dialect
    home: str | None  # namespace of the <bml>
    notices: list[Notice] = field(default_factory=list)

    def refuse(self, place: Place, what: str, remedy: str) -> BmlError:
        """Builds the error that refuses the document."""
        return refusal(self.source, place, what, remedy)

    def note(self, kind: NoticeType, text: str, *, behaviour: str | None = None) -> None:
        """Keeps a notice about the block or one of its behaviours."""
        self.notices.append(Notice(kind, self.block if behaviour is None else f"{self.block}:{behaviour}", text))


@dataclass(frozen=True)
class BehaviourElement:
    """A behaviour's element with its id and its attributes by local name."""

    id: str
    element: Element
    attributes: Mapping[str, str]

    def word(self, *names: str, default: str = "") -> str:
        """First of the attributes that is written, without white space around it."""
        written = (self.attributes[name].strip() for name in names if name in self.attributes)
        return next(written, default)


def read_number(named: BehaviourElement, name: str, reading: DocumentReading, *, default: float) -> float:
    """Reads an attribute as a number.

    Raises:
        BmlError: not a number, not finite, or beyond `LARGEST_NUMBER`.
    """
    text = named.word(name)
    return read_finite(text, name, named.element.place, reading) if text else default


def read_whole(named: BehaviourElement, name: str, reading: DocumentReading, *, default: int, largest: int) -> int:
    """Reads an attribute as a whole number from 1.

    Raises:
        BmlError: not whole, or outside 1 to `largest`.
    """
    value = read_number(named, name, reading, default=default)
    if value != int(value) or not 1 <= value <= largest:
        what = f"{name}='{named.word(name)}' is no whole number from 1 to {largest}"
        raise reading.refuse(named.element.place, what, f"for example {name}='{default}'")
    return int(value)


def read_finite(text: str, name: str, place: Place, reading: DocumentReading) -> float:
    """Reads a text as a number.

    Raises:
        BmlError: not a number, not finite, or beyond `LARGEST_NUMBER`.
    """
    try:
        value = float(text)
    except ValueError:
        raise reading.refuse(place, f"{name}='{text}' is no number", f"for example {name}='0.5'") from None
    if not math.isfinite(value) or abs(value) > LARGEST_NUMBER:
        raise reading.refuse(place, f"{name}='{text}' is out of range", f"finite, at most {LARGEST_NUMBER:g}")
    return value
