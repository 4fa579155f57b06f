"""Check of the letters that espeak-ng's voices can read.

For an unreadable letter espeak-ng speaks a name like "Chinese letter". In espeak-ng 1.52 every voice reads letters of
most Indian scripts, of Armenian, Georgian and Korean; the scripts below are read only in languages that are written
with them.
"""

import unicodedata
from collections.abc import Mapping

from kinesic.body.pictographs import is_pictograph

_CHINESE_LANGUAGES = frozenset({"cmn", "hak", "yue"})  # espeak-ng languages written in Chinese characters
_JAPANESE_LANGUAGES = frozenset({"ja"})  # espeak-ng languages written in kana
_CYRILLIC_LANGUAGES = "ba be bg cv kk kaa ky mk nog ru sr tk tt uk uz"  # espeak-ng languages written in Cyrillic
_LETTER_LANGUAGES: Mapping[str, frozenset[str]] = {  # first word of a letter's Unicode name -> languages that read it
    "CJK": _CHINESE_LANGUAGES,
    "IDEOGRAPHIC": _CHINESE_LANGUAGES,
    "BOPOMOFO": _CHINESE_LANGUAGES,
    "HIRAGANA": _JAPANESE_LANGUAGES,
    "KATAKANA": _JAPANESE_LANGUAGES,
    "KATAKANA-HIRAGANA": _JAPANESE_LANGUAGES,
    "ARABIC": frozenset({"ar", "fa", "ku", "sd", "ug", "ur"}),
    "CHEROKEE": frozenset({"chr"}),
    "CYRILLIC": frozenset(_CYRILLIC_LANGUAGES.split()),
    "ETHIOPIC": frozenset({"am", "ti"}),
    "HEBREW": frozenset({"he"}),
    "MYANMAR": frozenset({"my", "shn"}),
    "ORIYA": frozenset({"or"}),
    "TELUGU": frozenset({"te"}),
    "THAI": frozenset({"th"}),
    **dict.fromkeys(("COPTIC", "GLAGOLITIC", "GOTHIC", "JAVANESE", "KHMER", "LAO", "MONGOLIAN", "NKO"), frozenset()),
    **dict.fromkeys(("RUNIC", "SYRIAC", "THAANA", "TIBETAN", "TIFINAGH", "YI"), frozenset()),
}
_WIDTH_PREFIXES = ("HALFWIDTH ", "FULLWIDTH ")  # prefixes of Unicode names of letters of other widths


def unreadable_letters(text: str, voice: str) -> str:
    """Return the distinct letters and pictographs that a voice cannot read.

    Args:
        text: text to say.
        voice: espeak-ng's name of the voice, such as `sit/cmn` or `gmw/en-US`.
    """
    language = voice.rpartition("/")[2].partition("-")[0].lower()
    return "".join(dict.fromkeys(letter for letter in text if not _is_readable(language, letter)))


def _is_readable(language: str, letter: str) -> bool:
    if letter.isascii() or not letter.isalpha():
        return not is_pictograph(letter)
    name = unicodedata.name(letter, "")
    for width in _WIDTH_PREFIXES:
        name = name.removeprefix(width)
    readers = _LETTER_LANGUAGES.get(name.partition(" ")[0])
    return readers is None or language in readers
