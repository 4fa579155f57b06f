"""The type that text and FML become: what somebody means with a stretch of speech, how sure that is, and why."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Moment:
    """A time in a block as its BML says it, and when that is, about."""

    reference: str  # of BML: `s:w3`, `s:w3+0.12`, `1.5`
    seconds: float  # [s] estimated, from the start of the block; it orders and spaces, and is never performed

    def later(self, seconds: float) -> "Moment":
        """Returns the moment so many seconds later, or earlier."""
        return Moment(shift_reference(self, seconds), self.seconds + seconds)


@dataclass(frozen=True)
class Intent:
    """Something that is meant: a function of the talk, an emotion, a place, the rhythm of a phrase."""

    name: str  # of its behaviour set: `negation`, `deictic-you`, `emotion-joy`
    start: Moment
    stroke: Moment  # where it is strongest: the stressed syllable of its word
    end: Moment
    certainty: float  # 0..1; what is least certain is left out first
    reason: str  # for people: which words, and what they mean
    lexemes: tuple[str, ...] = ()  # gestures that show it, where its words say more than its set
    word: int = -1  # index of the word of its stroke; -1: there are no words
    phrase: int = -1  # index of the phrase of this word, or -1
    style: str = ""  # manner in which its sentence is performed, if it asks for one
    target: str = ""  # what it points at, if it names something
    strength: float = 1.0  # 0..1 of how much its face and head show it


def shift_reference(moment: Moment, seconds: float) -> str:
    """Writes the reference of a moment so many seconds later, or earlier; never before the block."""
    reference, offset = split_reference(moment.reference)
    later = (offset or 0.0) + seconds
    if not reference:
        return f"{max(later, 0.0):.2f}"
    return reference if abs(later) < 0.005 else f"{reference}{later:+.2f}"


def split_reference(reference: str) -> tuple[str, float | None]:
    """Splits a time of BML into a reference without its offset, empty for a number, and the offset [s]."""
    bare = reference.replace(" ", "")
    for sign in "+-":
        before, found, offset = bare.rpartition(sign)
        if found and _is_number(offset):
            return before, float(f"{sign}{offset}")
    return ("", float(bare)) if _is_number(bare) else (bare, None)


def _is_number(text: str) -> bool:
    return text.isascii() and text.replace(".", "", 1).isdigit()
