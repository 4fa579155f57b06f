"""Speech as facts: the text that is asked for, and when its marks and phonemes fall."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol


@dataclass(frozen=True)
class Mark:
    """A named place in a text, before the character at `position`."""

    name: str
    position: int


@dataclass(frozen=True)
class Script:
    """Text to be said, with marks between its words."""

    text: str
    marks: tuple[Mark, ...] = ()
    language: str = "en"


@dataclass(frozen=True)
class Phoneme:
    """One sound of an utterance."""

    symbol: str
    start: float  # [s] from the start of the utterance
    duration: float  # [s]


@dataclass(frozen=True)
class Utterance:
    """A script as it will be said."""

    duration: float  # [s]
    marks: Mapping[str, float] = field(default_factory=dict)  # name -> [s] from the start of the utterance
    phonemes: tuple[Phoneme, ...] = ()
    voice: str = ""  # the engine that says it


class Voice(Protocol):
    """A speech engine: a pure function from text to facts about its sound."""

    def say(self, script: Script, /, *, rate: float = 1.0) -> Utterance:
        """Says a script at a rate (1: normal, 2: twice as fast)."""
