"""Estimated times of speech marks, for the order and spacing of intents.

The performance does not use them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kinesic.bml.block import MAX_BLOCK_DURATION
from kinesic.bml.reading.script import MARK_ELEMENTS, find_spoken_element
from kinesic.bml.reading.tree import Element
from kinesic.intent.intents import Moment, split_reference
from kinesic.intent.reading.passage import SYLLABLE_DURATION, WORD_OVERHEAD
from kinesic.intent.reading.stress import count_syllables

MARK_ATTRIBUTES = ("id", "name")  # attributes with the name of a mark


@dataclass(frozen=True)
class MarkTimes:
    """Estimated times of the marks of speeches."""

    times: Mapping[str, float]  # estimated time [s] by `speech:mark`, `speech:start` and `speech:end`

    def moment(self, written: str) -> Moment | None:
        """Convert an FML time reference to a time in the block.

        Args:
            written: seconds (`1.5`), or a mark, with or without an offset (`s1:tm3`, `s1:tm3+0.5`).

        Returns:
            None if it is malformed, names an unknown mark, or exceeds the longest block.
        """
        reference, offset = split_reference(written)
        if (reference and reference not in self.times) or (not reference and offset is None):
            return None
        seconds = self.times.get(reference, 0.0) + (offset or 0.0)
        return Moment(written.replace(" ", ""), seconds) if seconds <= MAX_BLOCK_DURATION else None

    def speech_end(self, written: str) -> Moment | None:
        """Return the end of the speech named in a reference, or None."""
        return self.moment(f"{written.partition(':')[0].strip()}:end")


def estimate_mark_times(bml: Element) -> MarkTimes:
    """Estimate the times of all marks of a block."""
    times: dict[str, float] = {}
    time = 0.0
    for speech in (child for child in bml.children if child.local == "speech"):
        name = speech.attributes.get("id", "").strip()
        start = MarkTimes(times).moment(speech.attributes.get("start", ""))
        time = time if start is None else start.seconds
        times[f"{name}:start"] = time
        for piece in _list_pieces(find_spoken_element(speech)):
            if isinstance(piece, Element):
                mark = next((piece.attributes[name] for name in MARK_ATTRIBUTES if name in piece.attributes), "")
                times[f"{name}:{mark.strip()}"] = time
            else:
                time += sum(WORD_OVERHEAD + SYLLABLE_DURATION * count_syllables(word.lower()) for word in piece.split())
        times[f"{name}:end"] = time
    return MarkTimes(times)


def _list_pieces(element: Element) -> Iterator[Element | str]:
    """Yield the marks and words of a speech in order."""
    for piece in element.content:
        if isinstance(piece, str) or piece.local in MARK_ELEMENTS:
            yield piece
        elif piece.local != "description":
            yield from _list_pieces(piece)
