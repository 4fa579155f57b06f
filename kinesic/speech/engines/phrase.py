"""Interface of speech engines, which turn phrases into sound and times.

Any class with a `name` and a method `speak` is an engine; `EngineVoice` turns it into a voice. An engine may report
less than it could: without phonemes they are estimated between the words, without words from the sound alone.
"""

from dataclasses import dataclass
from typing import Protocol

from kinesic.body.utterance import Phoneme, Sound


class EngineError(RuntimeError):
    """Failure of a speech engine.

    The text gives the reason.
    """


class UnreadableError(EngineError):
    """Failure of an engine on a phrase without any readable word."""


@dataclass(frozen=True)
class ProsodySection:
    """Section of a phrase with its own rate, pitch and volume."""

    begin: int  # first character
    end: int  # after the last character
    rate: float = 1.0  # factor on the rate of the phrase
    pitch: float = 1.0  # factor on the pitch of the phrase
    volume: float = 1.0  # factor on the amplitude


@dataclass(frozen=True)
class Phrase:
    """Text without pauses, at most a sentence long."""

    text: str
    language: str = "en"  # BCP 47 tag
    rate: float = 1.0  # 1 is the engine's normal rate, 2 is twice as fast
    pitch: float = 1.0  # factor on the pitch of the voice
    sections: tuple[ProsodySection, ...] = ()  # outer sections before inner sections, whose factors are multiplied


@dataclass(frozen=True)
class SpokenWord:
    """Word of a phrase with its time in the sound."""

    begin: int  # first character in the phrase
    end: int  # after the last character
    start: float  # [s] from the first sample
    stop: float  # [s] from the first sample


@dataclass(frozen=True, eq=False)
class SpokenPhrase:
    """Sound of a phrase with the times of its words and phonemes.

    Times are from the first sample of the sound [s]. Silence at both ends is allowed; `EngineVoice` removes it.
    """

    sound: Sound
    words: tuple[SpokenWord, ...] = ()  # words in order; empty: the engine does not report words
    phonemes: tuple[Phoneme, ...] = ()  # phonemes (IPA) in order; empty: phonemes are estimated
    accents: tuple[float, ...] = ()  # [s] pitch peaks of accented syllables; empty: unknown
    remarks: tuple[str, ...] = ()  # parts of the phrase that the engine cannot say


class SpeechEngine(Protocol):
    """Program or model that speaks one phrase at a time.

    An engine must be hashable, and picklable for use in other processes.
    """

    @property
    def name(self) -> str:
        """Name of the engine in reports."""

    def __hash__(self) -> int:
        """Return the hash of an engine, equal for engines that speak alike."""

    def speak(self, phrase: Phrase, /) -> SpokenPhrase:
        """Synthesise a phrase.

        The result depends on the phrase alone, because it is cached.

        Raises:
            UnreadableError: no word of the phrase can be read.
            EngineError: the engine fails.
        """
