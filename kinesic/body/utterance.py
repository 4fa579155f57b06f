"""Text to be spoken, and the timing of its sound."""

import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Samples = NDArray[np.float32]
Stress = Literal["prosody", "emphasis", "say-as", "voice"]

VOWEL_LETTERS = frozenset("aeiouyäöüæɐɑɒɔəɚɛɜɝɪɨʊʉʌøœɵɤɯʏᵻ")  # noqa: RUF001 - vowels of spelling and of the phonetic alphabet
STRESS_MARKS = ("\u02c8", "\u02cc")  # Primary and secondary stress, written before the stressed syllable


@dataclass(frozen=True)
class Mark:
    """Named position in a text, before the character at `position`."""

    name: str
    position: int  # index of the character after the mark
    time: float | None = None  # [s] from the start of the speech, if the document sets it; None: the voice decides


@dataclass(frozen=True)
class Pause:
    """Pause of the voice before the character at `position` of a text."""

    position: int  # index of the character after the pause
    duration: float  # [s] length of the pause
    after: int = 0  # number of marks at this position that precede the pause


@dataclass(frozen=True)
class Emphasis:
    """Section of a text inside one SSML element, such as `emphasis`."""

    begin: int  # index of the first character
    end: int  # index after the last character
    element: Stress  # name of the SSML element
    attributes: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Recording:
    """Sound file that replaces synthesis, with the times of its marks."""

    path: Path  # WAV file
    marks: tuple[tuple[str, float], ...] = ()  # name and time [s] of each mark, from the start of the file
    folder: Path | None = None  # folder of the document, in which the files must lie; None: anywhere
    words: Path | None = None  # file with the times of words or phonemes; None: the words are found by their sound


@dataclass(frozen=True)
class Script:
    """Text to be spoken, with marks, pauses, emphases and language."""

    text: str
    marks: tuple[Mark, ...] = ()
    language: str = "en"  # BCP 47 tag, or the language name in the document
    pauses: tuple[Pause, ...] = ()
    emphases: tuple[Emphasis, ...] = ()  # sections with emphasis, outer before inner
    recording: Recording | None = None

    def stops(self) -> tuple[Mark | Pause, ...]:
        """List marks and pauses in text order."""
        placed: list[tuple[int, float, Mark | Pause]] = []
        count: dict[int, int] = {}
        for mark in self.marks:
            rank = count[mark.position] = count.get(mark.position, 0) + 1
            placed.append((mark.position, rank, mark))
        placed += [(pause.position, pause.after + 0.5, pause) for pause in self.pauses]
        return tuple(stop for *_, stop in sorted(placed, key=lambda place: place[:2]))


@dataclass(frozen=True)
class Phoneme:
    """One speech sound of an utterance, with its timing."""

    symbol: str
    start: float  # [s] time from the start of the utterance
    duration: float  # [s]
    onset: float | None = None  # [s] time from the utterance's start when the mouth reaches its shape; None: at `start`
    release: float | None = None  # [s] time from the utterance's start when the mouth leaves its shape; None: at `end`
    opening: float = 1.0  # relative lip opening by loudness; 1 at the median level of the speech

    @property
    def letters(self) -> str:
        """Letters of the symbol, without stress, length, tone and diacritics."""
        plain = unicodedata.normalize("NFD", self.symbol.casefold())
        return "".join(letter for letter in plain if unicodedata.category(letter) in ("Ll", "Lo"))

    @property
    def end(self) -> float:
        """End time [s] from the start of the utterance."""
        return self.start + self.duration

    @property
    def articulation(self) -> tuple[float, float]:
        """Start and end [s] of the articulated mouth shape.

        Times are from the start of the utterance.
        """
        onset = self.start if self.onset is None else self.onset
        return onset, self.end if self.release is None else self.release


@dataclass(frozen=True, eq=False)
class Sound:
    """Audio samples of one channel."""

    rate: int  # [Hz]
    samples: Samples  # (m,) samples, -1..1

    @property
    def duration(self) -> float:
        """Duration of the sound [s]."""
        return len(self.samples) / self.rate

    @classmethod
    def of(cls, rate: int, samples: ArrayLike) -> "Sound":
        """Make a sound from a read-only copy of samples (m,)."""
        copied: Samples = np.array(samples, dtype=np.float32)
        copied.setflags(write=False)
        return cls(rate, copied)


@dataclass(frozen=True)
class Utterance:
    """Timing and sound of a spoken script."""

    duration: float  # [s]
    marks: Mapping[str, float] = field(default_factory=dict)  # name -> [s] from the start of the utterance
    phonemes: tuple[Phoneme, ...] = ()
    voice: str = ""  # name of the engine
    sound: Sound | None = None  # None: timing only
    remarks: tuple[str, ...] = ()  # requested features that the voice cannot produce
    accents: tuple[float, ...] = ()  # [s] pitch peaks of accented syllables; empty: the voice reports none


class Voice(Protocol):
    """Speech engine, a pure function from text to timing and sound."""

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Synthesise the timing and sound of a script.

        Args:
            script: the text.
            rate: speaking rate; 1 is normal, 2 twice as fast.
            pitch: factor on the pitch of the voice.
        """
