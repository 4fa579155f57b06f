"""The types that plain text becomes: words with their punctuation, in phrases and sentences."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from kinesic.intent.intents import Moment
from kinesic.intent.reading.stress import count_syllables, stressed_syllable

SentenceKind = Literal["statement", "question", "exclamation"]

SPEECH = "s"  # id of the speech that says a text
SYLLABLE, WORD = 0.155, 0.05  # [s] of a syllable, and of a word on top of them: about 175 words in a minute
COMMA, STOP = 0.2, 0.45  # [s] of silence behind a phrase and a sentence
COMMAS = ",;:\u3001\uff0c"  # punctuation between phrases
ONSET = 0.45  # of a syllable: where its vowel sounds


@dataclass(frozen=True)
class Word:
    """One word of a text."""

    text: str  # as it is said
    plain: str  # in small letters, with a straight apostrophe
    before: str  # punctuation and space since the word before
    sentence: int  # from 0
    phrase: int  # from 0, through all sentences
    is_content: bool  # it says something of its own: no article, pronoun, preposition, auxiliary
    emphatic: bool = False  # the writer stresses it: CAPITALS, *asterisks*, SSML
    pause: float = 0.0  # [s] that is asked for before it, beside what its punctuation does
    end: int = 0  # place behind it in the text that was read


@dataclass(frozen=True)
class Passage:
    """A text in words, phrases and sentences."""

    words: tuple[Word, ...]
    kinds: tuple[SentenceKind, ...]  # of its sentences
    tail: str = ""  # behind the last word
    tail_pause: float = 0.0  # [s] that is asked for behind the last word
    feelings: tuple[tuple[int, str], ...] = ()  # sentence and emotion of each emoticon
    language: str = "en"
    is_over: bool = True  # its last phrase has ended: by punctuation, or because there is none

    @cached_property
    def sentences(self) -> tuple[Sequence[int], ...]:
        """The indices of the words of each sentence."""
        return _grouped((word.sentence for word in self.words), len(self.kinds))

    @cached_property
    def phrases(self) -> tuple[Sequence[int], ...]:
        """The indices of the words of each phrase."""
        return _grouped((word.phrase for word in self.words), self.words[-1].phrase + 1 if self.words else 0)

    @cached_property
    def content(self) -> tuple[Sequence[int], ...]:
        """The indices of the content words of each phrase."""
        return tuple([k for k in phrase if self.words[k].is_content] for phrase in self.phrases)

    @cached_property
    def starts(self) -> tuple[float, ...]:
        """When each word begins [s], about, and last when all is said."""
        times, now = [], 0.0
        for k, word in enumerate(self.words):
            if k and self.words[k - 1].sentence != word.sentence:
                now += STOP
            elif k and set(word.before) & set(COMMAS):
                now += COMMA
            now += word.pause
            times.append(now)
            now += word_duration(word)
        return (*times, now)

    def onset(self, index: int) -> Moment:
        """The moment when a word begins."""
        return Moment(f"{SPEECH}:{mark(index)}", self.starts[index])

    def stress(self, index: int) -> Moment:
        """The moment when the stressed syllable of a word sounds."""
        later = (stressed_syllable(self.words[index].plain) + ONSET) * SYLLABLE
        return Moment(f"{SPEECH}:{mark(index)}+{later:.2f}", self.starts[index] + later)

    def close(self, index: int) -> Moment:
        """The moment when a word has been said."""
        word = self.words[index]
        return Moment(f"{SPEECH}:{mark(index)}+{word_duration(word):.2f}", self.starts[index] + word_duration(word))


def _grouped(numbers: Iterable[int], count: int) -> tuple[Sequence[int], ...]:
    """The indices at which each number from 0 stands."""
    groups: list[list[int]] = [[] for _ in range(count)]
    for k, number in enumerate(numbers):
        groups[number].append(k)
    return tuple(groups)


def word_duration(word: Word) -> float:
    """Estimates how long a word takes to say [s]."""
    return WORD + SYLLABLE * count_syllables(word.plain)


def mark(index: int) -> str:
    """Names the sync point before a word."""
    return f"w{index + 1}"
