"""Reads plain text: words, phrases and sentences, what the writer stresses, where he pauses, and emoticons."""

import re
from dataclasses import dataclass, field
from functools import lru_cache

from kinesic.intent.reading.language import Language
from kinesic.intent.reading.passage import Passage, SentenceKind, Word
from kinesic.intent.reading.segmenting import segment

LEAST_CAPITALS = 2  # letters of a word in capitals that is stressed
SHOUTED = 0.7  # share of letters in capitals beyond which they stress nothing
LEAST_PHRASE = 4  # words before a conjunction that begins a phrase of its own
LONGEST_BREAK = 10.0  # [s] that a text may ask for
DASH, ELLIPSIS = 0.15, 0.4  # [s] of silence beside that of the voice

_TAG = re.compile(r"<(/?)([A-Za-z]\w*+(?:[:-]++\w++)*+)")  # the beginning of one
_ANY_TAG = re.compile(r"</?[A-Za-z][^<>]*+>")
_TIME = re.compile(r"time\s*=\s*[\"'](\d++(?:\.\d*+)?|\.\d++)(ms|s)[\"']")  # of a break
_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f\ufeff\ufffe\uffff\ud800-\udfff]")
_TOKENS = r"""
    (?P<tag></?[A-Za-z]\w*+(?:[:-]++\w++)*+[^<>]*+>)
    | (?P<stars>\*{{1,3}}|(?<!\w)_(?=\w)|(?<=\w)_(?!\w))
    | (?P<emoticon>{emoticon})
    | (?P<ellipsis>\.{{2,}}|\u2026)
    | (?P<dash>\s[-\u2013\u2014]{{1,2}}\s|\u2014|--)
    | (?P<word>\d+(?:[.,:]\d+)*(?:st|nd|rd|th|%)?|[^\W\d_]+(?:['\u2019\-][^\W\d_]+)*)
    | (?P<stop>[.!?\u3002\uff01\uff1f]+["'\u201d\u2019)]*)
    | (?P<comma>[,;:\u3001\uff0c])
    | (?P<other>\s+|.)
"""


def read_text(text: str, language: Language) -> Passage:
    """Splits a text into words, phrases and sentences.

    `*word*`, `_word_`, CAPITALS and SSML's <emphasis> are stressed; dashes, ellipses and SSML's <break> are pauses;
    emoticons are feelings of their sentence, and are not said.

    Args:
        text: as somebody wrote it, also with the tags of SSML.
        language: its abbreviations, emoticons, closed classes and conjunctions.
    """
    reading = _Reading(language, is_shouted=_is_shouted(_ANY_TAG.sub(" ", text) if "<" in text else text))
    for token in _tokens(language.emoticon).finditer(_CONTROLS.sub(" ", text)):
        reading.take(token.lastgroup or "", token[0], token.end())
    return reading.passage()


@lru_cache(maxsize=16)
def _tokens(emoticon: str) -> re.Pattern[str]:
    spaced = emoticon.replace(" ", r"\ ").replace("#", r"\#")
    return re.compile(_TOKENS.format(emoticon=spaced), re.VERBOSE | re.DOTALL)


def _is_shouted(text: str) -> bool:
    letters = [letter for letter in text if letter.isalpha()]
    return len(letters) > LEAST_CAPITALS and sum(map(str.isupper, letters)) > SHOUTED * len(letters)


@dataclass
class _Reading:
    """A text while it is read."""

    language: Language
    is_shouted: bool
    words: list[Word] = field(default_factory=list)
    kinds: list[SentenceKind] = field(default_factory=list)
    between: list[str] = field(default_factory=list)  # since the last word
    silence: float = 0.0  # [s] likewise
    is_phrase_over: bool = False
    is_stressed: bool = False
    feelings: list[tuple[int, str]] = field(default_factory=list)

    def take(self, kind: str, text: str, end: int) -> None:
        """Takes one token, which ends at a place of the text."""
        match kind:
            case "word":
                for word in segment(text, self.language):
                    self._add_word(word, end)
            case "tag":
                self._take_tag(text)
            case "stars":
                self.is_stressed = not self.is_stressed
            case "emoticon":
                self.feelings.append((max(len(self.kinds) - (not self._is_open()), 0), self.language.emoticons[text]))
            case "ellipsis" | "dash":
                self.silence += ELLIPSIS if kind == "ellipsis" else DASH
                self.between.append("... " if kind == "ellipsis" else ", ")
                self.is_phrase_over = True
            case "stop":
                self._stop(text)
            case _:
                self.between.append(" " if text.isspace() else text)
                self.is_phrase_over |= kind == "comma" or text in "()[]\u201c\u201d"

    def passage(self) -> Passage:
        """Returns what was read."""
        if self._is_open():
            self.kinds.append(self._kind(""))
        last = max(len(self.kinds) - 1, 0)
        feelings = tuple((min(sentence, last), feeling) for sentence, feeling in self.feelings if self.kinds)
        tail = " ".join("".join(self.between).split())
        is_over = self.is_phrase_over or not self.words
        return Passage(tuple(self.words), tuple(self.kinds), tail, self.silence, feelings, self.language.tag, is_over)

    def _take_tag(self, tag: str) -> None:
        """Takes SSML's stress and breaks; other tags are a space."""
        found = _TAG.match(tag)
        is_end, name = (bool(found[1]), found[2]) if found else (False, "")
        if name == "break" and not is_end and (time := _TIME.search(tag)):
            self.silence += min(float(time[1]) / (1000 if time[2] == "ms" else 1), LONGEST_BREAK)
            self.is_phrase_over = True
        elif name.lower() == "emphasis":
            self.is_stressed = not is_end
        else:
            self.between.append(" ")

    def _is_open(self) -> bool:
        """Whether the last word is of a sentence that has not ended."""
        return bool(self.words) and self.words[-1].sentence == len(self.kinds)

    def _add_word(self, text: str, end: int) -> None:
        plain = text.replace("\u2019", "'").lower()
        is_loud = len(text) >= LEAST_CAPITALS and text.isupper() and not self.is_shouted
        is_loud = is_loud and not self.language.has("acronym", plain)
        word = Word(
            text=text.lower() if is_loud or (self.is_shouted and len(text) > 1) else text,
            plain=plain,
            before=re.sub(r"\s+", " ", "".join(self.between)),
            sentence=len(self.kinds),
            phrase=self._phrase(plain),
            is_content=not self.language.has("function", plain),
            emphatic=is_loud or self.is_stressed,
            pause=self.silence,
            end=end,
        )
        self.words.append(word)
        self.between, self.silence, self.is_phrase_over = [], 0.0, False

    def _phrase(self, plain: str) -> int:
        """The phrase of the next word: a conjunction begins one where the last has some words already."""
        if not self.words:
            return 0
        last = self.words[-1].phrase
        size = sum(word.phrase == last for word in self.words[-LEAST_PHRASE:])
        begins = self.language.has("conjunction", plain) and size == LEAST_PHRASE
        return last + (self.is_phrase_over or begins)

    def _stop(self, text: str) -> None:
        last = self.words[-1].plain if self.words else ""
        self.between.append(text)
        is_short = self.language.has("abbreviation", last) or (len(last) == 1 and last.isalpha() and last != "i")
        if text == "." and (is_short or not self._is_open()):
            return
        if self._is_open():
            self.kinds.append(self._kind(text))
        elif self.kinds and self._kind(text) == "question":
            self.kinds[-1] = "question"
        self.is_phrase_over = True

    def _kind(self, stop: str) -> SentenceKind:
        """What a sentence is by the punctuation at its end, or by its last word where the language tells by that."""
        if "?" in stop or "\uff1f" in stop or self.language.has("question_end", self.words[-1].plain):
            return "question"
        return "exclamation" if "!" in stop or "\uff01" in stop else "statement"
