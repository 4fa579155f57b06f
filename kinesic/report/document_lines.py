"""The document as it was read, line by line, with the behaviours whose elements begin on each line."""

from collections import defaultdict
from dataclasses import dataclass

from kinesic.bml.block import Behaviour, Block

MOST_LINES = 2000  # of a longer document the beginning is listed


@dataclass(frozen=True)
class DocumentLine:
    """A line of the document."""

    number: int  # from 1
    text: str
    behaviours: tuple[Behaviour, ...]  # whose elements begin on it


def document_lines(block: Block) -> tuple[DocumentLine, ...]:
    """Cuts a document into lines, without empty ones at its end; none where its text is not known."""
    if not block.text:
        return ()
    begun: defaultdict[int, list[Behaviour]] = defaultdict(list)
    for behaviour in block.behaviours:
        begun[behaviour.place.line].append(behaviour)
    text = block.text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n")
    lines = text.split("\n")  # as XML has it: others end no line
    return tuple(DocumentLine(number, text, tuple(begun[number])) for number, text in enumerate(lines[:MOST_LINES], 1))
