"""Speech engine whose words are tones, for tests of engine voices."""

import re
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.body.utterance import Phoneme, Sound
from kinesic.speech.engines.phrase import Phrase, SpokenPhrase, SpokenWord, UnreadableError

SAMPLE_RATE = 8000  # [Hz] sample rate of the tones
WORD_DURATION = 0.3  # [s] duration of a word at rate 1
LEAD_TIME = 0.25  # [s] silence before the first and after the last word


@dataclass(frozen=True)
class ToneEngine:
    """Engine that reports words and phonemes, words alone, or nothing."""

    reports: Literal["phonemes", "words", "nothing"] = "phonemes"
    name: str = "tones"

    def speak(self, phrase: Phrase, /) -> SpokenPhrase:
        """Return one tone per word.

        Words of only the letter x are skipped; a text of only such words is unreadable.
        """
        matches = [match for match in re.finditer(r"\w+", phrase.text) if set(match[0]) != {"x"}]
        if not matches:
            raise UnreadableError(f"no word of {phrase.text!r} can be read")
        each = WORD_DURATION / phrase.rate
        starts = [LEAD_TIME + number * each for number in range(len(matches))]
        count = round((2 * LEAD_TIME + len(matches) * each) * SAMPLE_RATE)
        times = np.arange(count) / SAMPLE_RATE
        is_spoken = (times >= LEAD_TIME) & (times < LEAD_TIME + len(matches) * each)
        sound = Sound.of(SAMPLE_RATE, np.where(is_spoken, 0.5 * np.cos(2 * np.pi * 200 * (times - LEAD_TIME)), 0.0))
        words = tuple(
            SpokenWord(m.start(), m.end(), start, start + each) for m, start in zip(matches, starts, strict=True)
        )
        phonemes = tuple(Phoneme("a", start, each) for start in starts)
        return SpokenPhrase(
            sound,
            () if self.reports == "nothing" else words,
            phonemes if self.reports == "phonemes" else (),
            tuple(starts[:1]),
        )
