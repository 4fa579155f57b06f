"""The type that text and FML become: what somebody means with a stretch of speech, how sure that is, and why."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Moment:
    """A time in a block as its BML says it, and when that is, about."""

    reference: str  # of BML: `s:w3`, `s:w3+0.12`, `1.5`
    seconds: float  # [s] estimated, from the start of the block; it orders and spaces, and is never performed


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
