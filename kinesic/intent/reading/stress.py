"""Syllables and stress of English words by their spelling."""

import re

_VOWEL_PATTERN = re.compile(r"[aeiouy]+")
_SILENT_END = re.compile(
    r"(?<![aeiouyl])e$|(?<![aeiouylxszcgh])es$|(?<=[aeiouyr])les?$|(?<![dt])(?<=[^aeiouy])ed$|(?<=[aeiou])ed$"
)
_HIATUS_PATTERN = re.compile(
    r"i(?=a(?!r?ge)|o(?!u|n)|u)|(?<=[^q])u(?=[aeio](?!u))(?=al|at|ou|it|en)|e(?=o|at[ei])|y(?=i)|a(?=o)"
)
_DIGIT_PATTERN = re.compile(r"\d+")
_KANA_PATTERN = re.compile("[\u3041-\u30ff]")
_WEAK_KANA = re.compile(
    "[\u3041\u3043\u3045\u3047\u3049\u3083\u3085\u3087\u30a1\u30a3\u30a5\u30a7\u30a9\u30e3\u30e5\u30e7]"
)  # small kana, pronounced with the preceding kana
_KANJI_PATTERN = re.compile("[\u3400-\u9fff\u3005]")
_STRESS_BEFORE_ENDING = re.compile(  # endings with the stress on the syllable before them
    r"(tion|sion|cian|cious|tious|cial|tial|ics?|ical(ly)?|ity|ify|ian|ions?|ious(ly)?|eous|iar|ient|ience)$"
)
_STRESSED_ENDING = re.compile(r"(ee|eer|ese|ette|esque|oon|self|selves|ade|aire)$")
_WEAK_PREFIX = re.compile(  # unstressed first syllables
    r"^(a(?=bout|bove|cc|cr|dd|djust|dm|dv|ff|fr|gain|gg|go|gree|head|lert|live|lone|long|mong|maz|nn|noth|part|pp|rou"
    r"|rr(?!o)|sc|sh|sid|sk|sl|ss|st|tt|void|wa|way)|be(?=[^aeiou]+[aeiou])|com(?=[bmp][aeiloru])|con(?=[^aeiou]+)"
    r"|de(?=[^aeiou]+[aeiouy])|di(?=gest|rect|vid|vor)|dis|e(?=n|x|mb|mp|con|lat|lim|ras|vap)n?|for(?=b|g)|fru|im"
    r"|in(?=[^aeiou]+[aeiou]..)|mis|ob|op(?=p)|per(?=[^aeiou][aeiou]..)|po(?=lite|ss)|pre|pro(?=[^aeiou]+[aeiou]..)"
    r"|re(?=[^aeiou]+[aeiouy])|se(?=cur|lec|ren)|sub|suc(?=c)|sup(?=p)|sug(?=g)|sur(?=[pr])|to(?=[dgmnw])|trans|un|up)"
)
_FIRST_WORDS = """
able absence absent accurate acid action addict address adult angry answer any apple army arrogance arrogant attic
beauty beaver beckon beg being belief belly berry better beverage body combat comfort comment common compass
competent complex complicate complicated concentrate concept concert conduct confidence confident congress conquer
conscious constant construct contact contemplate content contest context continent contour contract contrary
contrast danger day decade decent definite definitely delicate demon demonstrate density dentist desert desperate
desperately detail detective devil digit distance distant district edge edit effort either emphasis emphasize empire
empty enemy energy engine english enter entrance entry envy error even evening event every excellent exercise exit
expert extra extract forest income increase index indicate industry infant influence inner input insect insert
insight instance instant instinct instrument interest interesting interrupt interval interview miserable mission
mister never object obstacle obvious offer office often only open operate opposite order over people percent perfect
permanent person precious pregnant present pressure pretty process product profit program programme project promise
prosper provident public ready real really reason recent recipe record rectangle region regular relative rent rescue
resolute rest restaurant sentence separate subject subsequent substance substitute subtle suburb suffer transfer
transit transport uncle under union unit universe update upper upward
"""
_FIRST_STRESSED = frozenset(_FIRST_WORDS.split())  # words stressed on an apparent prefix
_SECOND_WORDS = """
ability advice afraid agenda alarm allow alright alternative amen among analysis another antique anxiety apologize
apology appear aside asleep astronomer away banana became because become before begin behind belief believe belong
below beneath beside besides between beyond bizarre canoe career catastrophe cathedral cigar computer create
creative delicious despite dessert detective develop device economy eleven else enormous enough evaluate event
eventually example farewell fatigue goodbye guitar hello horizon hotel however hurray idea ignore imagine important
incredible inside instead july machine magnificent majority manipulate material minority mistake museum myself
necessity november october okay outside parade particular perhaps piano police postpone potato relate ridiculous
romance romantic salute september sincere superb technique technology terrain themselves tomato tomorrow tonight
tornado toward towards triumphant unique upset variety whatever whenever wherever whoever within without
"""
_SECOND_STRESSED = frozenset(
    _SECOND_WORDS.split()
)  # words stressed on the second syllable without a matching ending or prefix
LONGEST_ENDING = 5  # [letters] length of the longest unstressed word ending
_WEAK_ENDINGS = re.compile(r"(ing|er|ers|ed|es|ly|ness|ment|ments|ful|less|able|ible|(?<!s)s)$")


def count_syllables(word: str) -> int:
    """Return the number of syllables of a word, at least one.

    It is an approximation for the name of a number, and for the morae of Japanese.
    """
    digits = _DIGIT_PATTERN.search(word)
    if digits:
        return max(1, round(1.5 * len(digits[0])))
    morae = len(_KANA_PATTERN.findall(word)) - len(_WEAK_KANA.findall(word)) + 2 * len(_KANJI_PATTERN.findall(word))
    return max(1, morae or len(_find_vowel_groups(word)))


def stressed_english_syllable(word: str) -> int:
    """Return the index of a word's stressed syllable, from 0.

    Endings have precedence (`-tion`, `-ity`, `-self`), then weak prefixes (`about`, `begin`, `remember`). Otherwise the
    first syllable is stressed, as in most English words.
    """
    letters = word.lower()
    count = count_syllables(letters)
    if count == 1 or _DIGIT_PATTERN.search(letters):
        return 0
    if letters in _FIRST_STRESSED:
        return 0
    if letters in _SECOND_STRESSED:
        return 1
    if _STRESSED_ENDING.search(letters):
        return count - 1
    ending = _STRESS_BEFORE_ENDING.search(letters)
    if ending:
        return max(0, count - 1 - max(1, len(_find_vowel_groups(ending[0]))))
    stem = _strip_endings(letters)
    if stem in _FIRST_STRESSED:
        return 0
    if stem in _SECOND_STRESSED:
        return 1
    return 1 if _WEAK_PREFIX.match(letters) and count > 1 and count_syllables(stem) > 1 else 0


def _strip_endings(letters: str) -> str:
    """Remove a word's endings that never carry the stress."""
    end = len(letters)
    while (ending := _WEAK_ENDINGS.search(letters, max(end - LONGEST_ENDING, 0), end)) and ending.start() > 2:
        end = ending.start()
    return letters[:end]


def _find_vowel_groups(word: str) -> list[str]:
    """Return a word's pronounced vowel groups, without a silent final e."""
    letters = re.sub(r"[^a-z]", "", word.lower())
    pronounced = _SILENT_END.sub("", letters) if len(_VOWEL_PATTERN.findall(letters)) > 1 else letters
    return _VOWEL_PATTERN.findall(_HIATUS_PATTERN.sub(lambda match: f"{match[0]}-", pronounced))
