"""Speech as facts: the text that is asked for, what it sounds like, and when its marks and phonemes fall."""

import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Samples = NDArray[np.float32]
Stress = Literal["prosody", "emphasis", "say-as", "voice"]

VOWELS = frozenset("aeiouyäöüæɐɑɒɔəɚɛɜɝɪɨʊʉʌøœɵɤɯʏᵻ")  # noqa: RUF001 - letters of the phonetic alphabet
STRESSES = ("\u02c8", "\u02cc")  # before a sound whose syllable is stressed, the stronger first


@dataclass(frozen=True)
class Mark:
    """A named place in a text, before the character at `position`."""

    name: str
    position: int
    time: float | None = None  # [s] from the start of the speech, where the document says it; None: as the voice has it


@dataclass(frozen=True)
class Pause:
    """Silence in a text, before the character at `position`."""

    position: int
    duration: float  # [s]
    after: int = 0  # so many of the marks at this position come before it, the others after it


@dataclass(frozen=True)
class Emphasis:
    """A stretch of text that is said in a way of its own, in the words of SSML."""

    begin: int  # first character
    end: int  # after the last character
    element: Stress
    attributes: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Recording:
    """A sound that is played instead of an engine's, and when the marks fall in it."""

    path: Path  # of a WAV file
    marks: tuple[tuple[str, float], ...] = ()  # name, [s] from the start of the file
    folder: Path | None = None  # in which it must lie, that of the document which names it; None: anywhere


@dataclass(frozen=True)
class Script:
    """Text to be said, with marks between its words."""

    text: str
    marks: tuple[Mark, ...] = ()
    language: str = "en"  # BCP 47 tag, or the name of a language as the document has it
    pauses: tuple[Pause, ...] = ()
    emphases: tuple[Emphasis, ...] = ()  # outer ones before those inside them
    recording: Recording | None = None

    def stops(self) -> tuple[Mark | Pause, ...]:
        """Lists marks and pauses in their order."""
        placed: list[tuple[int, float, Mark | Pause]] = []
        count: dict[int, int] = {}
        for mark in self.marks:
            rank = count[mark.position] = count.get(mark.position, 0) + 1
            placed.append((mark.position, rank, mark))
        placed += [(pause.position, pause.after + 0.5, pause) for pause in self.pauses]
        return tuple(stop for *_, stop in sorted(placed, key=lambda place: place[:2]))


@dataclass(frozen=True)
class Phoneme:
    """One sound of an utterance."""

    symbol: str
    start: float  # [s] from the start of the utterance
    duration: float  # [s]
    onset: float | None = None  # [s] likewise, when the mouth has come to it; None: at its start
    release: float | None = None  # [s] likewise, when the mouth lets go, as at a burst; None: at its end

    @property
    def letters(self) -> str:
        """Letters of its symbol, without stress, length, tone and diacritics."""
        plain = unicodedata.normalize("NFD", self.symbol.casefold())
        return "".join(letter for letter in plain if unicodedata.category(letter) in ("Ll", "Lo"))

    @property
    def end(self) -> float:
        """[s] from the start of the utterance."""
        return self.start + self.duration

    @property
    def made(self) -> tuple[float, float]:
        """[s] from the start of the utterance, between which the mouth has its shape."""
        onset = self.start if self.onset is None else self.onset
        return onset, self.end if self.release is None else self.release


@dataclass(frozen=True, eq=False)
class Sound:
    """Samples of one channel."""

    rate: int  # [Hz]
    samples: Samples  # (m,) -1..1

    @property
    def duration(self) -> float:
        """[s]."""
        return len(self.samples) / self.rate

    @classmethod
    def of(cls, rate: int, samples: ArrayLike) -> "Sound":
        """Takes a read-only copy of (m,) samples."""
        own: Samples = np.array(samples, dtype=np.float32)
        own.setflags(write=False)
        return cls(rate, own)


@dataclass(frozen=True)
class Utterance:
    """A script as it will be said."""

    duration: float  # [s]
    marks: Mapping[str, float] = field(default_factory=dict)  # name -> [s] from the start of the utterance
    phonemes: tuple[Phoneme, ...] = ()
    voice: str = ""  # the engine that says it
    sound: Sound | None = None  # None: it is known how long it takes, but not heard
    remarks: tuple[str, ...] = ()  # what the listener does not get as asked


class Voice(Protocol):
    """A speech engine: a pure function from text to facts about its sound."""

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Says a script at a rate (1: normal, 2: twice as fast) and a pitch (times the voice's own)."""
