"""Estimates the timing of speech without an engine, and without sound."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

from kinesic.body.utterance import Mark, Pause, Phoneme, Script, Utterance
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


@dataclass(frozen=True)
class DurationModel:
    """A voice that speaks 150 to 180 English words in a minute, always the same way."""

    remark: str = ""  # of every utterance: why this voice says it, where another was wanted

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Times a script.

        A word takes its syllables and a little more, a pause the longest that its punctuation asks for, or what the
        script has there, which no rate changes; nothing is silent before the first word or after the last, unless the
        script has a pause there. A mark falls at the start of the next word, at the start of a pause that it stands
        before, or at the end.

        Args:
            script: what to say; of marks with the same name the first counts. How words are stressed is passed over.
            rate: 1 is normal, 2 is twice as fast; above 0.
            pitch: not heard.

        Raises:
            ValueError: the rate is not a number above 0.
        """
        if not (math.isfinite(rate) and rate > 0):
            raise ValueError(f"rate is {rate}, must be a finite number above 0")
        now, silence, between, begun = 0.0, 0.0, 0.0, False
        waiting: list[str] = []
        marks: dict[str, float] = {}
        phonemes: list[Phoneme] = []
        for piece in _pieces(script):
            if isinstance(piece, Mark):
                waiting.append(piece.name)
            elif isinstance(piece, Pause):
                for name in waiting:
                    marks.setdefault(name, now + between)
                waiting = []
                between += piece.duration
            elif (kind := piece.lastgroup or "") in _PAUSES:
                silence = max(silence, _PAUSES[kind] / rate) if begun else 0.0
            else:
                now += max(silence, between)
                silence, between, begun = 0.0, 0.0, True
                for name in waiting:
                    marks.setdefault(name, now)
                waiting = []
                sounds, duration = _spoken(kind, piece.group(), script.language)
                phonemes += _spread(sounds, now, duration / rate)
                now += duration / rate
        now += between
        for name in waiting:
            marks.setdefault(name, now)
        remarks = (self.remark,) if self.remark else ()
        return Utterance(now, marks, tuple(phonemes), "durations", remarks=remarks)


def _pieces(script: Script) -> Iterator[Mark | Pause | re.Match[str]]:
    """Yields marks, pauses and tokens in their order; a stop inside a word comes after the word."""
    stops = list(script.stops())
    for token in _TOKEN.finditer(script.text):
        while stops and stops[0].position <= token.start():
            yield stops.pop(0)
        yield token
    yield from stops


def _spoken(kind: str, text: str, language: str) -> tuple[tuple[str, ...], float]:
    """Finds sounds and duration [s] at rate 1 of a word, a number or a character."""
    if kind == "mora":
        return mora_sounds(text), MORA
    sounds = number_sounds(text) if kind == "number" else word_sounds(text, language=language)
    return sounds, WORD + SYLLABLE * syllables(sounds)


def _spread(sounds: Sequence[str], start: float, duration: float) -> list[Phoneme]:
    """Spreads sounds over a duration [s], one after the other."""
    shares = [VOWEL_SHARE if sound in VOWELS else 1.0 for sound in sounds]
    whole = sum(shares)
    ends = [start + duration * part / whole for part in accumulate(shares, initial=0.0)]
    return [Phoneme(sound, begin, end - begin) for sound, begin, end in zip(sounds, ends, ends[1:], strict=False)]
