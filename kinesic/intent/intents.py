"""Intents: meanings of text or FML, with times, certainty and reason."""

from dataclasses import dataclass, replace
from typing import Literal

ChosenHand = Literal["", "left", "right"]  # empty: the hand that the gesture usually uses


@dataclass(frozen=True)
class Moment:
    """Time of an intent: BML reference with estimated seconds."""

    reference: str  # BML reference: `s:w3`, `s:w3+0.12`, `1.5`
    seconds: float  # [s] estimated time in the block, only for order and spacing

    def later(self, seconds: float) -> "Moment":
        """Return the moment shifted by a signed time [s]."""
        return Moment(shift_reference(self, seconds), self.seconds + seconds)


@dataclass(frozen=True)
class Intent:
    """Meaning to show by behaviours: discourse function, emotion, place or phrase rhythm."""

    name: str  # name of the behaviour set: `negation`, `deictic-you`, `emotion-joy`
    start: Moment
    stroke: Moment  # peak: the stressed syllable of the stroke's word
    end: Moment
    certainty: float  # 0..1; the least certain intents are dropped first
    reason: str  # description for people: the words and their meaning
    lexemes: tuple[str, ...] = ()  # gestures that show the intent better than those of its behaviour set; empty: none
    substitutes: tuple[str, ...] = ()  # further gestures of the same meaning, less specific than `lexemes`
    word: int = -1  # index of the word on which the stroke falls; -1: no words
    phrase: int = -1  # index of that word's phrase; -1: no words
    style: str = ""  # style that the intent requests for the word's sentence; empty: none
    target: str = ""  # target to point at; empty: none
    hand: ChosenHand = ""  # hand of a gesture that may use either hand; empty: not chosen yet
    strength: float = 1.0  # 0..1 factor on the amounts of facial expressions and head movements
    muted: frozenset[str] = frozenset()  # channels that do not show the intent

    def counted_from(self, zero: float) -> "Intent":
        """Return the intent with estimated times relative to another time [s]."""
        moments = (Moment(each.reference, each.seconds - zero) for each in (self.start, self.stroke, self.end))
        start, stroke, end = moments
        return replace(self, start=start, stroke=stroke, end=end)


def shift_reference(moment: Moment, seconds: float) -> str:
    """Return the BML reference of a time plus an offset [s].

    A time in the block is at least 0.
    """
    reference, offset = split_reference(moment.reference)
    later = (offset or 0.0) + seconds
    if not reference:
        return f"{max(later, 0.0):.2f}"
    return reference if abs(later) < 0.005 else f"{reference}{later:+.2f}"


def split_reference(reference: str) -> tuple[str, float | None]:
    """Split a BML time into a reference and an offset [s].

    The reference is empty for a number.
    """
    bare = reference.replace(" ", "")
    for sign in "+-":
        before, matched_sign, offset = bare.rpartition(sign)
        if matched_sign and _is_number(offset):
            return before, float(f"{sign}{offset}")
    return ("", float(bare)) if _is_number(bare) else (bare, None)


def _is_number(text: str) -> bool:
    return text.isascii() and text.replace(".", "", 1).isdigit()
