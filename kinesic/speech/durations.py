"""Speech without an engine: a voice that makes no sound and knows how long everything would take."""

import math
import re
from bisect import bisect_left
from collections.abc import Sequence
from itertools import accumulate

from kinesic.body.utterance import Phoneme, Script, Utterance
from kinesic.speech.spelling import VOWELS, mora_sounds, number_sounds, syllables, word_sounds

SYLLABLE = 0.18  # [s]
WORD = 0.06  # [s] of a word, on top of its syllables
MORA = 0.14  # [s] of a Chinese, Japanese or Korean character
PHRASE_PAUSE = 0.2  # [s] at a comma
SENTENCE_PAUSE = 0.45  # [s]
VOWEL_SHARE = 2.0  # length of a vowel, in consonants

_APOSTROPHE = "'\u2019"
_CJK = "\u3041-\u30fa\u30fc-\u30ff\u3400-\u4dbf\u4e00-\u9fff\uac00-\ud7a3"
_TOKEN = re.compile(
    rf"""
    (?P<sentence>[.?!\u2026\u3002\uff01\uff1f])
    | (?P<phrase>[,;:\u3001\uff0c\uff1b\uff1a])
    | (?P<number>\d+(?:[.,:]\d+)*)
    | (?P<mora>[{_CJK}])
    | (?P<word>[^\W\d_{_CJK}](?:[{_APOSTROPHE}\u0300-\u036f]|[^\W\d_{_CJK}])*)
    """,
    re.VERBOSE,
)
_PAUSES = {"sentence": SENTENCE_PAUSE, "phrase": PHRASE_PAUSE}


class DurationModel:
    """A voice that speaks 150 to 180 English words in a minute, always the same way."""

    def say(self, script: Script, /, *, rate: float = 1.0) -> Utterance:
        """Times a script.

        A word takes its syllables and a little more, a pause the longest that its punctuation asks for; nothing is
        silent before the first word or after the last. A mark falls at the start of the next word, or at the end.

        Args:
            script: what to say; of marks with the same name the first counts.
            rate: 1 is normal, 2 is twice as fast; above 0.

        Raises:
            ValueError: the rate is not a number above 0.
        """
        if not (math.isfinite(rate) and rate > 0):
            raise ValueError(f"rate is {rate}, must be a finite number above 0")
        now, pause = 0.0, 0.0
        positions: list[int] = []
        starts: list[float] = []
        phonemes: list[Phoneme] = []
        for token in _TOKEN.finditer(script.text):
            kind = token.lastgroup or ""
            if kind in _PAUSES:
                pause = max(pause, _PAUSES[kind]) if starts else 0.0
                continue
            now, pause = now + pause, 0.0
            sounds, duration = _spoken(kind, token.group(), script.language)
            positions.append(token.start())
            starts.append(now)
            phonemes += _spread(sounds, now, duration, rate)
            now += duration
        marks: dict[str, float] = {}
        for mark in script.marks:
            following = bisect_left(positions, mark.position)
            marks.setdefault(mark.name, (starts[following] if following < len(starts) else now) / rate)
        return Utterance(now / rate, marks, tuple(phonemes), "durations")


def _spoken(kind: str, text: str, language: str) -> tuple[tuple[str, ...], float]:
    """Sounds and duration [s] of a word, a number or a character, at rate 1."""
    if kind == "mora":
        return mora_sounds(text), MORA
    sounds = number_sounds(text) if kind == "number" else word_sounds(text, language=language)
    return sounds, WORD + SYLLABLE * syllables(sounds)


def _spread(sounds: Sequence[str], start: float, duration: float, rate: float) -> list[Phoneme]:
    """Sounds one after the other from start to start + duration, divided by the rate."""
    shares = [VOWEL_SHARE if sound in VOWELS else 1.0 for sound in sounds]
    ends = [start + duration * part / sum(shares) for part in accumulate(shares, initial=0.0)]
    return [
        Phoneme(sound, begin / rate, (end - begin) / rate)
        for sound, begin, end in zip(sounds, ends, ends[1:], strict=False)
    ]
