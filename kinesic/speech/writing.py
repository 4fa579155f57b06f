"""Which letters espeak-ng reads in which language; of others it tells the name, "Chinese letter", and not the word.

Tried with espeak-ng 1.52: letters of most Indian scripts, of Armenian, Georgian and Korean it reads in every language,
those below in the languages that are written with them.
"""

import unicodedata
from collections.abc import Mapping

_CHINESE = frozenset({"cmn", "hak", "yue"})
_JAPANESE = frozenset({"ja"})
_CYRILLIC = "ba be bg cv kk kaa ky mk nog ru sr tk tt uk uz"
_READERS: Mapping[str, frozenset[str]] = {  # first word of a letter's name in Unicode -> languages that read it
    "CJK": _CHINESE,
    "IDEOGRAPHIC": _CHINESE,
    "BOPOMOFO": _CHINESE,
    "HIRAGANA": _JAPANESE,
    "KATAKANA": _JAPANESE,
    "KATAKANA-HIRAGANA": _JAPANESE,
    "ARABIC": frozenset({"ar", "fa", "ku", "sd", "ug", "ur"}),
    "CHEROKEE": frozenset({"chr"}),
    "CYRILLIC": frozenset(_CYRILLIC.split()),
    "ETHIOPIC": frozenset({"am", "ti"}),
    "HEBREW": frozenset({"he"}),
    "MYANMAR": frozenset({"my", "shn"}),
    "ORIYA": frozenset({"or"}),
    "TELUGU": frozenset({"te"}),
    "THAI": frozenset({"th"}),
    **dict.fromkeys(("COPTIC", "GLAGOLITIC", "GOTHIC", "JAVANESE", "KHMER", "LAO", "MONGOLIAN", "NKO"), frozenset()),
    **dict.fromkeys(("RUNIC", "SYRIAC", "THAANA", "TIBETAN", "TIFINAGH", "YI"), frozenset()),
}
_WIDTHS = ("HALFWIDTH ", "FULLWIDTH ")


def unreadable_letters(text: str, voice: str) -> str:
    """Finds the letters of a text that a voice cannot read, each once and in their order.

    Args:
        text: to be said.
        voice: espeak-ng's name for it, such as `sit/cmn` or `gmw/en-US`.
    """
    language = voice.rpartition("/")[2].partition("-")[0].lower()
    return "".join(dict.fromkeys(letter for letter in text if not _reads(language, letter)))


def _reads(language: str, letter: str) -> bool:
    if letter.isascii() or not letter.isalpha():
        return True
    name = unicodedata.name(letter, "")
    for width in _WIDTHS:
        name = name.removeprefix(width)
    readers = _READERS.get(name.partition(" ")[0])
    return readers is None or language in readers
