"""Cuts a text without spaces into words: at its particles and known words, and where the script changes."""

from typing import Literal

from kinesic.intent.reading.language import Language

WritingSystem = Literal["hiragana", "katakana", "kanji", "other"]

LONGEST_WORD = 12  # letters of a known word


def segment(text: str, language: Language) -> list[str]:
    """Cuts letters without spaces into words; joined they are the text again.

    Known words are found first, the longest one; else a word goes on to where the script changes, and takes the
    hiragana behind it that are no word of their own (`食べ`). Unknown words all in hiragana may be cut wrongly.
    """
    if not language.has_particles:
        return [text]
    starts: list[int] = []
    is_known, at = True, 0  # whether the last word is over for certain
    while at < len(text):
        known = _known(text, at, language, is_over=is_known or _script(text[at - 1]) != "hiragana")
        if known or is_known or _changes(text[at - 1], text[at]):
            starts.append(at)
        is_known, at = bool(known), at + len(known or text[at])
    return [text[start:end] for start, end in zip(starts, [*starts[1:], len(text)], strict=True)]


def _known(text: str, at: int, language: Language, *, is_over: bool) -> str:
    """The longest known word that begins at a letter, or nothing; a particle only behind a word that is over."""
    for end in range(min(len(text), at + LONGEST_WORD), at, -1):
        word = text[at:end]
        if end - at == 1 and (at == 0 or not is_over) and _script(word) == "hiragana":
            continue
        if language.has("final", word) and end < len(text):
            continue
        if language.knows(word) and not (_script(word[-1]) == "kanji" and _goes_on(text, end)):
            return word
    return ""


def _goes_on(text: str, end: int) -> bool:
    return end < len(text) and _script(text[end]) == "kanji"


def _changes(before: str, after: str) -> bool:
    """Whether a word ends between two letters; hiragana behind others are its ending."""
    one, other = _script(before), _script(after)
    return one != other and other != "hiragana"


def _script(letter: str) -> WritingSystem:
    code = ord(letter)
    if 0x3041 <= code <= 0x309F:
        return "hiragana"
    if 0x30A1 <= code <= 0x30FF:
        return "katakana"
    return "kanji" if 0x3400 <= code <= 0x9FFF or letter == "々" else "other"
