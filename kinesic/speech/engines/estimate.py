"""Estimation of word and phoneme times missing from an engine."""

import re
from collections.abc import Sequence
from dataclasses import replace

from kinesic.body.utterance import Mark, Phoneme, Script
from kinesic.speech.alignment import align_phonemes, find_audible_spans, order_anchors
from kinesic.speech.durations import DurationModel
from kinesic.speech.engines.phrase import Phrase, SpokenPhrase, SpokenWord

_WORD_PATTERN = re.compile(r"[^\s\W]+(?:['\u2019\-][^\s\W]+)*")


def complete(phrase: Phrase, spoken: SpokenPhrase) -> SpokenPhrase:
    """Add estimated words and phonemes to a phrase without them.

    Phonemes are distributed by the duration model over the audible time of their words.
    """
    if spoken.words and spoken.phonemes:
        return spoken
    begins = [word.begin for word in spoken.words] or [match.start() for match in _WORD_PATTERN.finditer(phrase.text)]
    marks = tuple(Mark(str(number), begin) for number, begin in enumerate(begins))
    estimate = DurationModel().say(Script(phrase.text, marks, phrase.language))
    anchors = [(estimate.marks[str(number)], word.start) for number, word in enumerate(spoken.words)]
    phonemes, place = align_phonemes(
        estimate.phonemes,
        order_anchors(anchors, estimate.duration, spoken.sound.duration),
        find_audible_spans(spoken.sound),
    )
    words = spoken.words
    if not words:
        starts = [place(estimate.marks[str(number)]) for number in range(len(begins))]
        words = _find_words(phrase.text, starts, phonemes, spoken.sound.duration)
    return replace(spoken, words=words, phonemes=spoken.phonemes or phonemes)


def _find_words(
    text: str, starts: Sequence[float], phonemes: Sequence[Phoneme], duration: float
) -> tuple[SpokenWord, ...]:
    """Return words with estimated starts and ends."""
    words = []
    for match, start, following in zip(_WORD_PATTERN.finditer(text), starts, (*starts[1:], duration), strict=True):
        stop = max((p.end for p in phonemes if start <= p.start < following), default=following)
        words.append(SpokenWord(match.start(), match.end(), start, min(stop, following)))
    return tuple(words)
