"""Sounds of written words, roughly: enough to count syllables and move lips, in any language of Latin script."""

import re
import unicodedata
from collections.abc import Mapping

VOWELS = frozenset("aeiouə")
DIGITS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
LETTERS_PER_SYLLABLE = 2.5  # where the script is unknown
SYLLABIC_SCRIPTS = ("HIRAGANA LETTER", "KATAKANA LETTER", "HANGUL SYLLABLE")

# The longest spelling wins; sounds that look alike on the lips share a symbol.
SOUNDS: Mapping[str, tuple[str, ...]] = {
    "sch": ("ʃ",),
    "tch": ("t", "ʃ"),
    "ch": ("t", "ʃ"),
    "sh": ("ʃ",),
    "th": ("θ",),
    "ph": ("f",),
    "wh": ("w",),
    "ck": ("k",),
    "ng": ("n", "g"),
    "qu": ("k", "w"),
    "ee": ("i",),
    "oo": ("u",),
    "a": ("a",),
    "b": ("b",),
    "c": ("k",),
    "d": ("d",),
    "e": ("e",),
    "f": ("f",),
    "g": ("g",),
    "h": ("h",),
    "i": ("i",),
    "j": ("d", "ʃ"),
    "k": ("k",),
    "l": ("l",),
    "m": ("m",),
    "n": ("n",),
    "o": ("o",),
    "p": ("p",),
    "q": ("k",),
    "r": ("r",),
    "s": ("s",),
    "t": ("t",),
    "u": ("u",),
    "v": ("v",),
    "w": ("w",),
    "x": ("k", "s"),
    "y": ("i",),
    "z": ("z",),
    "æ": ("a",),
    "œ": ("o",),
    "ø": ("o",),
    "ð": ("θ",),
    "þ": ("θ",),
    "đ": ("d",),
    "ł": ("w",),
}
_SPELLING = re.compile("|".join(sorted(SOUNDS, key=len, reverse=True)))
_SILENT_E = re.compile(r"(?<=[^aeiouy])(?<![^aeiouy]l)e$")  # make, but not little
_SILENT_E_LANGUAGES = ("en", "fr")


def word_sounds(word: str, *, language: str = "en") -> tuple[str, ...]:
    """Finds the sounds of a word in order, at least one of them a vowel.

    Args:
        word: letters of one word; accents do not matter.
        language: BCP 47 tag; English and French have a silent e.

    Returns:
        Symbols of the International Phonetic Alphabet. A word in a script that is not Latin is as many neutral
        vowels as it probably has syllables.
    """
    letters = _plain(word)
    if language.casefold().startswith(_SILENT_E_LANGUAGES):
        shorter = _SILENT_E.sub("", letters)
        letters = shorter if syllables(_spoken(shorter)) else letters
    sounds = _spoken(letters)
    if not sounds:
        return ("ə",) * max(1, round(len(letters) / LETTERS_PER_SYLLABLE))
    return sounds if syllables(sounds) else ("ə", *sounds)


def number_sounds(number: str) -> tuple[str, ...]:
    """Finds the sounds of a number read digit by digit; characters that are no digits are silent."""
    digits = [unicodedata.digit(character, None) for character in number]
    return tuple(sound for digit in digits if digit is not None for sound in word_sounds(DIGITS[digit]))


def mora_sounds(character: str) -> tuple[str, ...]:
    """Finds the sounds of a Chinese, Japanese or Korean character; a neutral vowel where it hides its sound."""
    name = unicodedata.name(character, "")
    if name.startswith(SYLLABIC_SCRIPTS):
        return word_sounds(name.split()[-1], language="")
    return ("ə",)


def syllables(sounds: tuple[str, ...]) -> int:
    """Counts vowel groups."""
    return sum(sound in VOWELS and before not in VOWELS for before, sound in zip(("", *sounds), sounds, strict=False))


def _plain(word: str) -> str:
    return "".join(c for c in unicodedata.normalize("NFD", word.casefold()) if c.isalpha())


def _spoken(letters: str) -> tuple[str, ...]:
    return tuple(sound for spelling in _SPELLING.findall(letters) for sound in SOUNDS[spelling])
