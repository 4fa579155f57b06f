"""Syllables and stress of words in any language, by script and spelling."""

import re
import unicodedata
from functools import lru_cache

from kinesic.body.scripts import HAN_LETTERS
from kinesic.intent.reading import stress

WORD_CACHE_SIZE = 8192  # [words] largest number of words whose syllables are cached
LETTERS_PER_SYLLABLE = 2.5  # mean letters per syllable in scripts of unknown structure
CONSONANTS_PER_SYLLABLE = 2.0  # letters per syllable of scripts without vowels
ENGLISH_RULES = frozenset({"en", "ja"})  # languages whose syllables the module `stress` counts
_INITIAL_TAGS = "af cs da de et fi fo hu is lb lv mn nb nl nn no sk sv"
_FINAL_TAGS = "az ba cmn fa fr he hi ht hy kk km ky lo my th tk tr tt ug ur uz vi yue zh"
_ACCENTED_TAGS = "ca es eu gl oc pt ro"
INITIAL_STRESS = frozenset(_INITIAL_TAGS.split())  # languages with stressed first syllables
FINAL_STRESS = frozenset(_FINAL_TAGS.split())  # languages with stressed last syllables
# Languages in which most final consonants move the stress to the last syllable.
CONSONANT_END_STRESS = frozenset(_ACCENTED_TAGS.split())
ACCENTED_STRESS = CONSONANT_END_STRESS | {"el", "it"}  # languages in which a written accent marks the stress
GERMANIC_PREFIXES = {  # unstressed first syllables
    "de": re.compile(r"(be|ge|er|ver|zer|ent|emp)(?=[^aeiouäöüy]*[aeiouäöüy].)(?![^aeiouäöü]e[lnrst]{0,2}$)"),
    "nl": re.compile(r"(be|ge|er|her|ver|ont)(?=[^aeiouy]*[aeiouy].)(?![^aeiou]e[lnrst]{0,2}$)"),
}
GERMANIC_ENDINGS = {  # endings with the stress on their first syllable
    "de": re.compile(r"(ionen|ion|ieren|iert|tät|täten|ei|eien|ur|enz|ist|isten|ant|ent|ell|al|är)$"),
    "nl": re.compile(r"(atie|aties|iteit|eren|eerd|eert|ij|ijen|uur|ist|isten|ant|ent|eel|aal|air)$"),
}

_LATIN_VOWELS = "aeiouy\u00e6\u0153\u00f8\u0131\u0259\u025b\u0254"
_OTHER_VOWELS = (  # vowel letters of Greek, Georgian and Armenian
    "\u03b1\u03b5\u03b7\u03b9\u03bf\u03c5\u03c9\u10d0\u10d4\u10d8\u10dd\u10e3\u0561\u0565\u0567\u0568\u056b\u0585"
)
_VOWEL_PATTERN = re.compile(f"[{_LATIN_VOWELS}{_OTHER_VOWELS}]+")
_STRONG_HIATUS = re.compile(r"(?<=[aeo])(?=[aeo])|(?<=[aeoiu])(?=[íúìù])|(?<=[íúìù])(?=[aeo])")
_NASAL_DIPHTHONG = re.compile("ã[oe]|õe")
_CYRILLIC_VOWELS = re.compile(
    "[\u0430\u0435\u0451\u0438\u043e\u0443\u044b\u044d\u044e\u044f\u0456\u0457\u0454\u045e\u04e9\u04af\u04b1\u04d9]"
)
_STRESS_MARKS = "\u0301\u0300\u0302"  # combining accents that mark the stress: acute, grave, circumflex
_TILDE_MARK = "\u0303"  # combining tilde; marks the stress in Portuguese unless the word has another accent
_HAN_PATTERN = re.compile(f"[{HAN_LETTERS}\uac00-\ud7a3\u1200-\u137f]")  # Chinese, Korean, Ethiopic: one syllable each
_INDIC_PATTERN = re.compile("[\u0900-\u0dff]")
_VIRAMA_PATTERN = re.compile("[\u094d\u09cd\u0a4d\u0acd\u0b4d\u0bcd\u0c4d\u0ccd\u0d4d\u0dca]")
_SEMITIC_PATTERN = re.compile("[\u0590-\u06ff]")
_SILENT_E = re.compile(r"(?<=[^aeiou])e(s|nt)?$")  # silent e at the end of a French word
_PENULTIMATE_END = {
    "pt": re.compile(r"([aeo]|[ae]m|[ae]ns|[aeo]s|em|ens)$"),
    "": re.compile(r"([aeiou]|[aeiou][ns])$"),
}  # endings with the stress before the last syllable


@lru_cache(maxsize=WORD_CACHE_SIZE)
def count_syllables(word: str, language: str = "en") -> int:
    """Return the number of syllables of a word, at least one.

    Args:
        word: in lower case.
        language: language without region, such as `pt`.
    """
    return stress.count_syllables(word) if _is_english(word, language) else max(1, len(_split(word, language)))


@lru_cache(maxsize=WORD_CACHE_SIZE)
def stressed_syllable(word: str, language: str = "en") -> int:
    """Return the index of a word's stressed syllable, from 0.

    A written accent decides where the language has one, otherwise prefixes and endings, otherwise the usual place.

    Args:
        word: in lower case.
        language: language without region, such as `pt`.
    """
    if _is_english(word, language):
        return stress.stressed_english_syllable(word)
    syllables = _split(word, language)
    last = max(len(syllables) - 1, 0)
    if language in ACCENTED_STRESS:
        return _find_accent(word, syllables, language)
    if language in INITIAL_STRESS:
        ending = GERMANIC_ENDINGS[language].search(word) if language in GERMANIC_ENDINGS else None
        if ending and last and ending.start() > 1:
            return max(last + 1 - max(1, len(_split(ending[0], language))), 0)
        prefix = GERMANIC_PREFIXES[language].match(word) if language in GERMANIC_PREFIXES else None
        return min(1, last) if prefix else 0
    return last if language in FINAL_STRESS else max(last - 1, 0)


def _is_english(word: str, language: str) -> bool:
    return language in ENGLISH_RULES or any(map(str.isdigit, word))


def _find_accent(word: str, syllables: list[str], language: str) -> int:
    """Return the index of the stressed syllable, in languages with written accents."""
    last = max(len(syllables) - 1, 0)
    for marks in (_STRESS_MARKS, _TILDE_MARK):
        marked = [k for k, each in enumerate(syllables) if set(marks) & set(unicodedata.normalize("NFD", each))]
        if marked:
            return marked[-1]
    ends_before = _PENULTIMATE_END.get(language, _PENULTIMATE_END[""])
    return last if language in CONSONANT_END_STRESS and not ends_before.search(word) else max(last - 1, 0)


def _split(word: str, language: str) -> list[str]:
    """Return each syllable's vowels, empty texts if only counted."""
    if language == "fr":
        word = _SILENT_E.sub("", word) if len(_vowel_groups(word, has_hiatus=False)) > 1 else word
    groups = (
        _vowel_groups(word, has_hiatus=language in ACCENTED_STRESS)
        or _CYRILLIC_VOWELS.findall(word)
        or _HAN_PATTERN.findall(word)
    )
    if groups:
        return groups
    letters = sum(map(str.isalpha, word))
    if _INDIC_PATTERN.search(word):
        count = float(letters - len(_VIRAMA_PATTERN.findall(word)))
    else:
        count = letters / (CONSONANTS_PER_SYLLABLE if _SEMITIC_PATTERN.search(word) else LETTERS_PER_SYLLABLE)
    return [""] * max(1, round(count))


def _vowel_groups(word: str, *, has_hiatus: bool) -> list[str]:
    """Return the vowels of each syllable, with their accents."""
    composed = unicodedata.normalize("NFC", word)
    plain = "".join(unicodedata.normalize("NFD", letter)[0] for letter in composed)
    groups: list[str] = []
    for match in _VOWEL_PATTERN.finditer(plain):
        letters = composed[match.start() : match.end()]
        if match.start() and plain[match.start() - 1] in "qg" and len(letters) > 1 and letters[0] == "u":
            letters = letters[1:]
        pieces = _STRONG_HIATUS.split(letters) if has_hiatus and not _NASAL_DIPHTHONG.fullmatch(letters) else [letters]
        groups += [piece for piece in pieces if piece]
    return groups
