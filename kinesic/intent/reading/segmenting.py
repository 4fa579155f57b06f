"""Word segmentation of text without spaces.

Words are separated at particles, at known words, and where the script changes.
"""

import re
from typing import Literal

from kinesic.body.scripts import HAN_LETTERS
from kinesic.intent.reading.language import Language

WritingSystem = Literal["hiragana", "katakana", "kanji", "other"]

LONGEST_WORD = 12  # [letters] longest dictionary word
_LETTER_GROUPS = (
    re.compile(  # splits Chinese into pairs of letters, Thai and Lao before each vowel that begins a syllable
        rf"[{HAN_LETTERS}]{{2}}(?![{HAN_LETTERS}](?![{HAN_LETTERS}]))|[{HAN_LETTERS}]{{1,3}}"
        r"|[\u0e00-\u0eff]{4,}?(?=[\u0e40-\u0e44\u0ec0-\u0ec4][\u0e00-\u0eff]{3})|[\u0e00-\u0eff]+"
        rf"|[^{HAN_LETTERS}\u0e00-\u0eff]+"
    )
)


def segment(text: str, language: Language) -> list[str]:
    """Divide letters without spaces into words.

    Joined they give the text again. In a language without rules, words are estimated by their length. Otherwise the
    longest known word has precedence, and a word extends to the next change of script, and includes following hiragana
    that are no word themselves (`食べ`). Unknown words in hiragana may be divided wrongly.
    """
    if not language.has_rules:
        return _LETTER_GROUPS.findall(text)
    if not language.has_particles:
        return [text]
    starts: list[int] = []
    is_known, at = True, 0  # is_known: whether the last word is certainly complete
    while at < len(text):
        dictionary_word = _find_known_word(text, at, language, is_over=is_known or _script(text[at - 1]) != "hiragana")
        if dictionary_word or is_known or _is_script_change(text[at - 1], text[at]):
            starts.append(at)
        is_known, at = bool(dictionary_word), at + len(dictionary_word or text[at])
    return [text[start:end] for start, end in zip(starts, [*starts[1:], len(text)], strict=True)]


def _find_known_word(text: str, at: int, language: Language, *, is_over: bool) -> str:
    """Return the longest dictionary word at a position, or an empty text.

    A particle is accepted only after a complete word.
    """
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


def _is_script_change(before: str, after: str) -> bool:
    """Return whether a change of script between two letters ends a word.

    Hiragana after another script continues the word, as its inflection.
    """
    one, other = _script(before), _script(after)
    return one != other and other != "hiragana"


def _script(letter: str) -> WritingSystem:
    code = ord(letter)
    if 0x3041 <= code <= 0x309F:
        return "hiragana"
    if 0x30A1 <= code <= 0x30FF:
        return "katakana"
    return "kanji" if 0x3400 <= code <= 0x9FFF or letter == "々" else "other"
