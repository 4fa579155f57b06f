"""Stems of English words, to compare inflected forms in a search."""

from functools import lru_cache

from kinesic.expressivity.lexicon.names import NAME_CACHE_SIZE

MIN_STEM_LENGTH = 3  # [letters] shortest stem after removal of an ending
# Endings of inflected words, in the order in which they are tried.
_STEM_ENDINGS = ("ingly", "edly", "ings", "ing", "ied", "ies", "ed", "es", "s", "ly", "er", "est")
_VOWEL_LETTERS = frozenset("aeiouy")


@lru_cache(maxsize=NAME_CACHE_SIZE)
def word_stem(word: str) -> str:
    """Return the common stem of a word's inflected forms.

    The stem need not be a word: wave, waves and waving become "wav".
    """
    for ending in _STEM_ENDINGS:
        stem = word.removesuffix(ending)
        if (
            stem != word
            and len(stem) >= MIN_STEM_LENGTH
            and not _VOWEL_LETTERS.isdisjoint(stem)
            and not word.endswith("ss")
        ):
            word = stem + "y" if ending in ("ied", "ies") else stem
            break
    word = word.removesuffix("e") if len(word) >= MIN_STEM_LENGTH else word
    return word[:-1] if len(word) > MIN_STEM_LENGTH and word[-1] == word[-2] else word
