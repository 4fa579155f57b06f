"""Lines of the source document with the behaviours that begin on each."""

from collections import defaultdict
from dataclasses import dataclass

from kinesic.bml.block import Behaviour, Block

MAX_LISTED_LINES = 2000  # document lines shown on the page; longer documents are cut


@dataclass(frozen=True)
class SourceLine:
    """A line of the document, with the behaviours that begin on it."""

    number: int  # from 1
    text: str
    behaviours: tuple[Behaviour, ...]  # whose elements begin on it


def document_lines(block: Block) -> tuple[SourceLine, ...]:
    """Split a document into lines with the behaviours that begin there.

    The result is empty if the text of the document is unknown.
    """
    if not block.text:
        return ()
    begun: defaultdict[int, list[Behaviour]] = defaultdict(list)
    for behaviour in block.behaviours:
        begun[behaviour.place.line].append(behaviour)
    text = block.text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n")
    lines = text.split("\n")  # XML has no other line ends
    return tuple(
        SourceLine(number, text, tuple(begun[number])) for number, text in enumerate(lines[:MAX_LISTED_LINES], 1)
    )
