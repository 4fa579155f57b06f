"""Words with punctuation, in phrases and sentences of a text."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from kinesic.body.scripts import PHRASE_STOPS
from kinesic.intent.intents import Moment
from kinesic.intent.reading.prosody import NO_LAYERS, Layers
from kinesic.intent.reading.syllables import count_syllables, stressed_syllable

SentenceKind = Literal["statement", "question", "exclamation"]

SPEECH_ID = "s"  # id of the speech behaviour
SYLLABLE_DURATION = 0.155  # [s] estimated duration of a syllable
WORD_OVERHEAD = 0.05  # [s] duration per word in addition to its syllables: about 175 words per minute
PHRASE_PAUSE = 0.2  # [s] estimated silence after a phrase
SENTENCE_PAUSE = 0.45  # [s] estimated silence after a sentence
_PHRASE_SIGNS = frozenset(PHRASE_STOPS)
VOWEL_FRACTION = 0.45  # fraction of a syllable before its vowel


@dataclass(frozen=True)
class Word:
    """One word of a text, with punctuation, phrase and sentence."""

    text: str  # word as spoken
    plain: str  # word in lower case, with a straight apostrophe
    before: str  # punctuation and space since the preceding word
    sentence: int  # index of the word's sentence
    phrase: int  # index of the word's phrase in the whole text
    is_content: bool  # whether this is a content word: no article, pronoun, preposition or auxiliary
    emphatic: bool = False  # whether the word is emphasised: CAPITALS, *asterisks*, SSML
    pause: float = 0.0  # [s] pause requested before the word, in addition to punctuation
    end: int = 0  # position after the word in the source text
    language: str = "en"  # language tag without region
    prosody: Layers = NO_LAYERS  # requested rate, pitch and volume of the voice


@dataclass(frozen=True)
class Passage:
    """Text divided into words, phrases and sentences."""

    words: tuple[Word, ...]
    kinds: tuple[SentenceKind, ...]  # kind of each sentence
    tail: str = ""  # text after the last word
    tail_pause: float = 0.0  # [s] pause requested after the last word
    feelings: tuple[tuple[int, str], ...] = ()  # (sentence index, emotion) of each emoticon
    language: str = "en"  # tag without region of the language whose rules apply
    is_over: bool = True  # whether the last phrase has ended, or there is no word
    directions: tuple[tuple[int, str], ...] = ()  # (index of the next word, stage direction)
    voice: str = ""  # language tag of the voice, such as `en-GB`; empty: `language`
    times: tuple[float, ...] = ()  # [s] start of each word and end of the text in a recording; empty: estimated
    accents: frozenset[int] | None = None  # indices of words accented in a recording; None: estimated from the text

    @cached_property
    def sentences(self) -> tuple[Sequence[int], ...]:
        """Word indices of each sentence."""
        return _group_words((word.sentence for word in self.words), len(self.kinds))

    @cached_property
    def phrases(self) -> tuple[Sequence[int], ...]:
        """Word indices of each phrase."""
        return _group_words((word.phrase for word in self.words), self.words[-1].phrase + 1 if self.words else 0)

    @cached_property
    def content(self) -> tuple[Sequence[int], ...]:
        """Indices of the content words of each phrase."""
        return tuple([k for k in phrase if self.words[k].is_content] for phrase in self.phrases)

    @cached_property
    def starts(self) -> tuple[float, ...]:
        """Start time of each word, and end of the text [s]."""
        if self.times:
            return self.times
        times, now = [], 0.0
        for k, word in enumerate(self.words):
            if k and self.words[k - 1].sentence != word.sentence:
                now += SENTENCE_PAUSE
            elif k and is_phrase_start(word):
                now += PHRASE_PAUSE
            now += word.pause
            times.append(now)
            now += word_duration(word)
        return (*times, now)

    def onset(self, index: int) -> Moment:
        """Return the time at which a word begins."""
        return Moment(f"{SPEECH_ID}:{mark(index)}", self.starts[index])

    def stress(self, index: int) -> Moment:
        """Return the time of a word's stressed vowel."""
        later = (stressed_syllable(self.words[index].plain, self.language) + VOWEL_FRACTION) * SYLLABLE_DURATION
        return Moment(f"{SPEECH_ID}:{mark(index)}+{later:.2f}", self.starts[index] + later)

    def close(self, index: int) -> Moment:
        """Return the time at which a word ends."""
        word = self.words[index]
        return Moment(f"{SPEECH_ID}:{mark(index)}+{word_duration(word):.2f}", self.starts[index] + word_duration(word))


def _group_words(numbers: Iterable[int], count: int) -> tuple[Sequence[int], ...]:
    """Return the word indices of each phrase or sentence, by number."""
    groups: list[list[int]] = [[] for _ in range(count)]
    for k, number in enumerate(numbers):
        groups[number].append(k)
    return tuple(groups)


def word_duration(word: Word) -> float:
    """Return the estimated duration of a word [s]."""
    return WORD_OVERHEAD + SYLLABLE_DURATION * count_syllables(word.plain, word.language)


def is_phrase_start(word: Word) -> bool:
    """Return whether punctuation that ends a phrase precedes a word."""
    return not _PHRASE_SIGNS.isdisjoint(word.before)


def mark(index: int) -> str:
    """Return the name of the sync point before a word."""
    return f"w{index + 1}"
