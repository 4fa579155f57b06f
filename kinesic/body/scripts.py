"""Punctuation and combining marks of the world's scripts, for regular expressions."""

import unicodedata

ARMENIAN_QUESTION_MARK = "\u055e"  # written inside a word, not after the sentence
QUESTION_MARKS = "?\uff1f\u061f\u1367\u2047\u2048\u2049"  # question marks: Latin, full-width, Arabic, Ethiopic, doubled
EXCLAMATION_MARKS = "!\uff01\u203c"  # exclamation marks: Latin, full-width, doubled
FULL_STOPS = ".\u2026\u3002\uff0e\uff61\u06d4\u0964\u0965\u1362\u0589\u104b\u17d4\u0df4"  # full stops of all scripts
SENTENCE_STOPS = FULL_STOPS + QUESTION_MARKS + EXCLAMATION_MARKS  # marks that end a sentence
PHRASE_STOPS = ",;:\u3001\uff0c\uff1b\uff1a\uff64\u060c\u061b\u1363\u1364\u104a\u0387"  # commas, colons, semicolons
# Sentence and phrase stops that need no space after them.
UNSPACED_STOPS = "\u3002\uff01\uff1f\u3001\uff0c\uff1b\uff1a\uff0e\u0964\u0965\u104a\u104b\u17d4"
HAN_LETTERS = "\u3005\u3007\u3400-\u4dbf\u4e00-\u9fff"  # Chinese characters

_FIRST_MARK = 0x0300  # first character with combining marks of modern scripts
_MARKS_END = 0x1800  # character after the last combining marks of modern scripts
_OTHER_MARKS = "\u055a-\u055c\u055e\u055f\u05f3\u05f4\u200c\u200d"  # signs inside Armenian and Hebrew words; joiners
COMBINING_MARKS = _OTHER_MARKS + "".join(  # signs within words other than letters: accents, vowel signs, joiners
    sign for sign in map(chr, range(_FIRST_MARK, _MARKS_END)) if unicodedata.category(sign) in ("Mn", "Mc")
)
