"""Silent voice that estimates the timing of speech without an engine."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

from kinesic.body.scripts import COMBINING_MARKS, PHRASE_STOPS, SENTENCE_STOPS
from kinesic.body.utterance import Mark, Pause, Phoneme, Script, Utterance
from kinesic.speech.prosody_rate import rate_at
from kinesic.speech.spelling import VOWEL_SOUNDS, count_syllables, mora_sounds, number_sounds, word_sounds

SYLLABLE_DURATION = 0.18  # [s] estimated duration of a syllable
WORD_DURATION = 0.06  # [s] estimated duration per word, in addition to its syllables
MORA_DURATION = 0.14  # [s] estimated spoken duration of a Chinese, Japanese or Korean character
PHRASE_PAUSE = 0.2  # [s] silence at a comma
SENTENCE_PAUSE = 0.45  # [s] silence at the end of a sentence
VOWEL_RATIO = 2.0  # duration of a vowel / duration of a consonant

_APOSTROPHE_SIGNS = "'\u2019"  # signs inside a word, as in don't
_CJK_RANGES = "\u3041-\u30fa\u30fc-\u30ff\u3400-\u4dbf\u4e00-\u9fff\uac00-\ud7a3"  # kana, Chinese characters, Hangul
_TOKEN_PATTERN = re.compile(
    rf"""
    (?P<sentence>[{SENTENCE_STOPS}])
    | (?P<phrase>[{PHRASE_STOPS}])
    | (?P<number>\d+(?:[.,:]\d+)*)
    | (?P<mora>[{_CJK_RANGES}])
    | (?P<word>[^\W\d_{_CJK_RANGES}](?:[{_APOSTROPHE_SIGNS}{COMBINING_MARKS}]|[^\W\d_{_CJK_RANGES}])*)
    """,
    re.VERBOSE,
)
_PAUSE_DURATIONS = {"sentence": SENTENCE_PAUSE, "phrase": PHRASE_PAUSE}  # [s] silence by kind of punctuation


@dataclass(frozen=True)
class DurationModel:
    """Silent voice with deterministic timing of 150 to 180 words per minute."""

    remark: str = ""  # remark added to every utterance: the reason for using this voice

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Estimate the speech timing of a script.

        The duration of a word is that of its syllables plus a constant. A pause has the longest duration that its
        punctuation or the script requires; script pauses do not depend on the rate. There is no silence before the
        first or after the last word unless the script has a pause there. A mark falls at the start of the next word, at
        the start of a following pause, or at the end.

        Args:
            script: text to say; of marks with the same name the first counts. Of its markup, only the rate of
                `prosody` counts.
            rate: 1 is normal, 2 is twice as fast; must be above 0.
            pitch: ignored.

        Raises:
            ValueError: the rate is not a finite number above 0.
        """
        if not (math.isfinite(rate) and rate > 0):
            raise ValueError(f"rate is {rate}, must be a finite number above 0")
        now, silence, between, has_started = 0.0, 0.0, 0.0, False
        waiting: list[str] = []
        marks: dict[str, float] = {}
        phonemes: list[Phoneme] = []
        for piece in _split_script(script):
            if isinstance(piece, Mark):
                waiting.append(piece.name)
            elif isinstance(piece, Pause):
                for name in waiting:
                    marks.setdefault(name, now + between)
                waiting = []
                between += piece.duration
            elif (kind := piece.lastgroup or "") in _PAUSE_DURATIONS:
                silence = max(silence, _PAUSE_DURATIONS[kind] / rate) if has_started else 0.0
            else:
                now += max(silence, between)
                silence, between, has_started = 0.0, 0.0, True
                for name in waiting:
                    marks.setdefault(name, now)
                waiting = []
                sounds, duration = _estimate_word(kind, piece.group(), script.language)
                duration /= rate * rate_at(script, piece.start())
                phonemes += _distribute(sounds, now, duration)
                now += duration
        now += between
        for name in waiting:
            marks.setdefault(name, now)
        remarks = (self.remark,) if self.remark else ()
        return Utterance(now, marks, tuple(phonemes), "durations", remarks=remarks)


def _split_script(script: Script) -> Iterator[Mark | Pause | re.Match[str]]:
    """Yield marks, pauses and tokens of a script in order.

    A mark or pause inside a word comes after the word.
    """
    stops = list(script.stops())
    for token in _TOKEN_PATTERN.finditer(script.text):
        while stops and stops[0].position <= token.start():
            yield stops.pop(0)
        yield token
    yield from stops


def _estimate_word(kind: str, text: str, language: str) -> tuple[tuple[str, ...], float]:
    """Return sounds and duration [s] of a spoken token at rate 1."""
    if kind == "mora":
        return mora_sounds(text), MORA_DURATION
    sounds = number_sounds(text) if kind == "number" else word_sounds(text, language=language)
    return sounds, WORD_DURATION + SYLLABLE_DURATION * count_syllables(sounds)


def _distribute(sounds: Sequence[str], start: float, duration: float) -> list[Phoneme]:
    """Return phonemes that fill a duration [s], vowels longer than consonants."""
    weights = [VOWEL_RATIO if sound in VOWEL_SOUNDS else 1.0 for sound in sounds]
    total = sum(weights)
    ends = [start + duration * part / total for part in accumulate(weights, initial=0.0)]
    return [Phoneme(sound, begin, end - begin) for sound, begin, end in zip(sounds, ends, ends[1:], strict=False)]
