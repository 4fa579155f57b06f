"""Consonants that a voice utters, for comparison with those of plain words."""

import re

from kinesic.body.utterance import Script
from kinesic.speech.espeak_pool import find_engine, synthesise
from kinesic.speech.ssml import write_ssml

FAST_RATE = 450  # [words/min] highest rate, so that synthesis is short
# vowels, glides and stress marks, which depend on the sentence
UNSTABLE_LETTERS = frozenset("aeiouyæɐɑɒɔəɚɛɜɝɪɨʊʉʌøœɵɤɯʏᵻɹjwːˈˌ")  # noqa: RUF001 - with glides and stress
# sounds that differ between positions in a sentence
EQUIVALENT_SOUNDS = str.maketrans({"ɾ": "t", "\u0294": "t", "z": "s"})
WORD_PATTERN = re.compile(r"[\w'\u2019]+(?:[-.,]\w+)*|[%&+=\xb0\u20ac$@/]")


def heard_consonants(script: Script) -> str:
    """Return the consonants of a script's speech, which are independent of stress."""
    paths = find_engine()
    assert paths is not None
    reply = synthesise(write_ssml(script), paths, voice="gmw/en-US", words_per_minute=FAST_RATE, pitch=50)
    symbols = (symbol for symbol, _ in reply.phonemes if "(" not in symbol)
    return "".join(
        letter for symbol in symbols for letter in symbol.translate(EQUIVALENT_SOUNDS) if _is_consonant(letter)
    )


def plain_words(text: str) -> Script:
    """Return a script of only a text's words and spoken signs."""
    return Script(" ".join(WORD_PATTERN.findall(text)))


def _is_consonant(letter: str) -> bool:
    return letter.isalpha() and letter not in UNSTABLE_LETTERS
