"""Estimates when each mark of a block's speeches comes: it orders and spaces intents, and times no performance."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kinesic.bml.reading.references import LONGEST_BLOCK
from kinesic.bml.reading.script import MARKS, spoken_part
from kinesic.bml.reading.tree import Element
from kinesic.intent.intents import Moment, split_reference
from kinesic.intent.reading.passage import SYLLABLE, WORD
from kinesic.intent.reading.stress import count_syllables

MARK_ATTRIBUTES = ("id", "name")  # that may hold the name of a mark


@dataclass(frozen=True)
class MarkTimes:
    """Estimated times of the marks of speeches."""

    times: Mapping[str, float]  # [s] by `speech:mark`, `speech:start` and `speech:end`

    def moment(self, written: str) -> Moment | None:
        """Resolves a time as FML has it; None where it is malformed, names an unknown mark, or no block lasts so long.

        Args:
            written: seconds (`1.5`), or a mark, with or without an offset (`s1:tm3`, `s1:tm3+0.5`).
        """
        reference, offset = split_reference(written)
        if (reference and reference not in self.times) or (not reference and offset is None):
            return None
        seconds = self.times.get(reference, 0.0) + (offset or 0.0)
        return Moment(written.replace(" ", ""), seconds) if seconds <= LONGEST_BLOCK else None

    def speech_end(self, written: str) -> Moment | None:
        """Finds the end of the speech that a time names; None without such a speech."""
        return self.moment(f"{written.partition(':')[0].strip()}:end")


def estimate_mark_times(bml: Element) -> MarkTimes:
    """Estimates the times of all marks of a block."""
    times: dict[str, float] = {}
    now = 0.0
    for speech in (child for child in bml.children if child.local == "speech"):
        name = speech.attributes.get("id", "").strip()
        found = MarkTimes(times).moment(speech.attributes.get("start", ""))
        now = now if found is None else found.seconds
        times[f"{name}:start"] = now
        for piece in _pieces(spoken_part(speech)):
            if isinstance(piece, Element):
                mark = next((piece.attributes[each] for each in MARK_ATTRIBUTES if each in piece.attributes), "")
                times[f"{name}:{mark.strip()}"] = now
            else:
                now += sum(WORD + SYLLABLE * count_syllables(word.lower()) for word in piece.split())
        times[f"{name}:end"] = now
    return MarkTimes(times)


def _pieces(element: Element) -> Iterator[Element | str]:
    """Yields marks and words in their order."""
    for piece in element.content:
        if isinstance(piece, str) or piece.local in MARKS:
            yield piece
        elif piece.local != "description":
            yield from _pieces(piece)
