"""Approximate sounds of written words in languages of Latin script.

They suffice to count syllables and to move lips.
"""

import re
import unicodedata
from collections.abc import Mapping

VOWEL_SOUNDS = frozenset("aeiouə")  # vowels of the estimated sounds
DIGIT_WORDS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
LETTERS_PER_SYLLABLE = 2.5  # estimated letters per syllable, for scripts of unknown structure
SYLLABIC_SCRIPTS = ("HIRAGANA LETTER", "KATAKANA LETTER", "HANGUL SYLLABLE")  # start of a character's Unicode name

# The longest spelling wins; sounds with the same lip shape have the same symbol.
SPELLING_SOUNDS: Mapping[str, tuple[str, ...]] = {
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
_SPELLING_PATTERN = re.compile("|".join(sorted(SPELLING_SOUNDS, key=len, reverse=True)))
_SILENT_E = re.compile(r"(?<=[^aeiouy])(?<![^aeiouy]l)e$")  # silent e of "make", but not of "little"
_SILENT_E_LANGUAGES = ("en", "fr")  # languages in which a final e is silent


def word_sounds(word: str, *, language: str = "en") -> tuple[str, ...]:
    """Return the approximate sounds of a word, at least one vowel.

    Args:
        word: letters of one word; accents are ignored.
        language: BCP 47 tag; English and French have a silent e.

    Returns:
        Symbols of the International Phonetic Alphabet. A word in a non-Latin script gives as many neutral vowels as it
        probably has
        syllables.
    """
    letters = _plain_letters(word)
    if language.casefold().startswith(_SILENT_E_LANGUAGES):
        without_e = _SILENT_E.sub("", letters)
        letters = without_e if count_syllables(_read_letters(without_e)) else letters
    sounds = _read_letters(letters)
    if not sounds:
        return ("ə",) * max(1, round(len(letters) / LETTERS_PER_SYLLABLE))
    return sounds if count_syllables(sounds) else ("ə", *sounds)


def number_sounds(number: str) -> tuple[str, ...]:
    """Return the sounds of a number read digit by digit.

    Other characters are silent.
    """
    digits = [unicodedata.digit(character, None) for character in number]
    return tuple(sound for digit in digits if digit is not None for sound in word_sounds(DIGIT_WORDS[digit]))


def mora_sounds(character: str) -> tuple[str, ...]:
    """Return the sounds of a Chinese, Japanese or Korean character.

    Characters of unknown sound give a neutral vowel.
    """
    name = unicodedata.name(character, "")
    if name.startswith(SYLLABIC_SCRIPTS):
        return word_sounds(name.split()[-1], language="")
    return ("ə",)


def count_syllables(sounds: tuple[str, ...]) -> int:
    """Count a word's syllables as groups of successive vowel sounds."""
    return sum(
        sound in VOWEL_SOUNDS and before not in VOWEL_SOUNDS
        for before, sound in zip(("", *sounds), sounds, strict=False)
    )


def _plain_letters(word: str) -> str:
    return "".join(c for c in unicodedata.normalize("NFD", word.casefold()) if c.isalpha())


def _read_letters(letters: str) -> tuple[str, ...]:
    return tuple(sound for spelling in _SPELLING_PATTERN.findall(letters) for sound in SPELLING_SOUNDS[spelling])
