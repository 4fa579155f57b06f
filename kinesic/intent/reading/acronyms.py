"""Acronyms among capitalised words, and whether they are spelled or spoken."""

import re

from kinesic.intent.reading.language import Language

MAX_ACRONYM_LENGTH = 5  # [letters] longest unlisted word in capitals without vowels that is read as an acronym
MAX_WORDLIKE_LENGTH = 3  # [letters] longest unlisted word in capitals with vowels that is read as an acronym
VOWEL_CAPITALS = frozenset("AEIOUYYÄÖÜÁÉÍÓÚÀÈÌÒÙÂÊÎÔÛ")  # capital letters of vowels


def read_acronym(text: str, before: str, following: str, language: Language) -> str:
    """Return an acronym's spoken form, or empty text for other words.

    Args:
        text: word in capitals.
        before: preceding word of its sentence; empty: it is the first one.
        following: beginning of the text after it.
        language: its acronyms, and its short words that are often in capitals for stress.
    """
    plain = text.lower()
    if any(map(str.isdigit, text)):
        return " ".join(re.findall(r"\d+|\D", text))
    if not text.isalpha() or "shouted" not in language.classes:
        return text if text.isalpha() and language.has("acronym", plain) else ""
    if language.has("ambiguous_acronym", plain):
        if not _is_name(text, before, following, language):
            return ""
    elif not language.has("acronym", plain) and not language.has("spoken_acronym", plain):
        is_unknown = not language.has("shouted", plain) and not language.knows(plain)
        limit = MAX_WORDLIKE_LENGTH if VOWEL_CAPITALS & set(text) else MAX_ACRONYM_LENGTH
        if not (is_unknown and len(text) <= limit):
            return ""
    if language.has("spoken_acronym", plain):
        return text
    return text if language.has("spelled_acronym", plain) else ".".join(text)


def _is_name(text: str, before: str, following: str, language: Language) -> bool:
    """Return whether the context makes an ambiguous acronym a name."""
    if text in ("AM", "PM"):
        return before[-1:].isdigit()
    after = following.lstrip()
    is_last = not after[:1].isalpha()
    if before in ("the", "a", "an"):
        return True
    is_place = before in ("in", "from", "to", "near", "across", "of", "for") and text in ("LA", "IT")
    is_first = not before and text in ("US", "LA") and not is_last
    return is_place or is_first or (text in ("LA", "US") and before == "in") or language.has("acronym", text.lower())
