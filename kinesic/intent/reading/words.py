"""Reader of plain text: words, phrases, sentences, emphasis, pauses and emoticons."""

import re
from dataclasses import dataclass, field
from functools import lru_cache

from kinesic.body.scripts import (
    ARMENIAN_QUESTION_MARK,
    COMBINING_MARKS,
    EXCLAMATION_MARKS,
    PHRASE_STOPS,
    QUESTION_MARKS,
    SENTENCE_STOPS,
)
from kinesic.intent.reading.acronyms import read_acronym
from kinesic.intent.reading.addresses import ADDRESS_PATTERN, split_address
from kinesic.intent.reading.language import Language
from kinesic.intent.reading.numbers import MAX_HEAD_DISTANCE, NUMBER_PATTERN, read_numeral, split_number
from kinesic.intent.reading.passage import Passage, SentenceKind, Word
from kinesic.intent.reading.prosody import NO_LAYERS, PROSODY_TAG, VOICE_TAG, Layers, take_tag
from kinesic.intent.reading.segmenting import segment

MIN_CAPITALS = 2  # smallest number of letters of an emphasised word in capitals
MAX_CAPITAL_FRACTION = 0.7  # fraction of capital letters in a text above which capitals mark no emphasis
MIN_PHRASE_LENGTH = 4  # smallest number of words before a conjunction that begins a new phrase
LONGEST_BREAK = 10.0  # [s] longest pause that a break tag can request
DASH_PAUSE = 0.15  # [s] silence at a dash, in addition to that of the voice
FOLLOWING_LENGTH = 20  # [letters] text after a token that helps to recognise acronyms and abbreviations
DIRECTION_TAG = "kinesic:act"  # tag of a stage direction in the text
QUOTATION_SIGNS = (
    "()[]\u201c\u201d\u201e\u00ab\u00bb\u300c\u300d\u300e\u300f\uff08\uff09\u300a\u300b"  # quotes and brackets
)
ELLIPSIS_PAUSE = 0.4  # [s] silence at an ellipsis, in addition to that of the voice

_TAG_PATTERN = re.compile(r"<(/?)([A-Za-z]\w*+(?:[:-]++\w++)*+)")  # beginning of a tag
_ANY_TAG = re.compile(r"</?[A-Za-z][^<>]*+>")
_TIME_PATTERN = re.compile(r"time\s*=\s*[\"'](\d++(?:\.\d*+)?|\.\d++)(ms|s)[\"']")  # attribute of a break
_NUMBERED_WORD = re.compile(r"\b[^\W\d]*+\d\w*+")  # words with digits (`H2O`, `5G`), whose capitals are no shouting
_WORDS_ATTRIBUTE = re.compile(r'words="([^"<>]*)"')
_CONTROL_PATTERN = re.compile(r"[\x00-\x08\x0b-\x1f\x7f\ufeff\ufffe\uffff\ud800-\udfff]")
_TOKEN_PATTERN = rf"""
    (?P<tag></?[A-Za-z]\w*+(?:[:-]++\w++)*+[^<>]*+>)
    | (?P<stars>\*{{{{1,3}}}}|(?<!\w)_(?=\w)|(?<=\w)_(?!\w))
    | (?P<emoticon>{{emoticon}})
    | (?P<ellipsis>\.{{{{2,}}}}|\u2026)
    | (?P<dash>\s[-\u2013\u2014]{{{{1,2}}}}\s|\u2014|--)
    | (?P<address>{ADDRESS_PATTERN.replace("{", "{{").replace("}", "}}")})
    | (?P<unit>{{unit}})
    | (?P<number>{NUMBER_PATTERN.replace("{", "{{").replace("}", "}}")})
    | (?P<word>\d+(?:[.,:]\d+)*(?:st|nd|rd|th|%)?|(?:[^\W\d_]\.)+[^\W\d_](?=\.)|[A-Z]+\d+[A-Z\d]*
        |[^\W\d_]+(?:(?:[{COMBINING_MARKS}]+|['\u2019\u00b7\u05be\-](?=[^\W\d_]))[^\W\d_]*)*)
    | (?P<stop>[{SENTENCE_STOPS}]+["'\u201d\u2019\u00bb\u300d\u300f)]*)
    | (?P<comma>[{PHRASE_STOPS}])
    | (?P<other>\s+|.)
"""


def read_text(text: str, language: Language) -> Passage:
    """Divide a text into words, phrases and sentences.

    `*word*`, `_word_`, CAPITALS that are no acronym, and SSML's <emphasis> are emphasis; dashes, ellipses and <break>
    are pauses;
    emoticons are emotions of their sentence, and are not spoken; tags of directions keep their place.

    Args:
        text: plain, or with the tags of SSML.
        language: its abbreviations, emoticons, closed classes and conjunctions.
    """
    reading = _Reading(language, is_shouted=_is_shouted(_ANY_TAG.sub(" ", text) if "<" in text else text))
    written = _CONTROL_PATTERN.sub(" ", text)
    for token in _tokens(language.emoticon, language.unit).finditer(written):
        reading.following = written[token.end() : token.end() + FOLLOWING_LENGTH]
        reading.take(token.lastgroup or "", token[0], token.end())
    return reading.passage()


@lru_cache(maxsize=16)
def _tokens(emoticon: str, unit: str) -> re.Pattern[str]:
    spaced = emoticon.replace(" ", r"\ ").replace("#", r"\#")
    return re.compile(_TOKEN_PATTERN.format(emoticon=spaced, unit=unit), re.VERBOSE | re.DOTALL)


def _is_shouted(text: str) -> bool:
    letters = [letter for letter in _NUMBERED_WORD.sub(" ", text) if letter.isalpha()]
    return len(letters) > MIN_CAPITALS and sum(map(str.isupper, letters)) > MAX_CAPITAL_FRACTION * len(letters)


@dataclass
class _Reading:
    """State of reading a text token by token."""

    language: Language
    is_shouted: bool
    words: list[Word] = field(default_factory=list)
    kinds: list[SentenceKind] = field(default_factory=list)
    between: list[str] = field(default_factory=list)  # pieces of text since the last word
    silence: float = 0.0  # [s] sum of pauses since the last word
    is_phrase_over: bool = False
    is_stressed: bool = False
    feelings: list[tuple[int, str]] = field(default_factory=list)
    directions: list[tuple[int, str]] = field(default_factory=list)
    asked: int = -1  # index of the last sentence with an Armenian question mark
    prosody: Layers = NO_LAYERS
    following: str = ""  # beginning of the text after the token

    def take(self, kind: str, text: str, end: int) -> None:
        """Append the words or punctuation of one token of the text."""
        match kind:
            case "word":
                for word in segment(text, self.language):
                    self._add_word(word, end)
            case "address":
                for k, word in enumerate(split_address(text, self.language)):
                    self.between += [" "] if k else []
                    self._add_word(word, end)
            case "number":
                before = [word.plain for word in self.words[-MAX_HEAD_DISTANCE:] if word.sentence == len(self.kinds)]
                for signs, part in split_number(text, self.language, before=before, after=self.following):
                    self.between += [signs]
                    self._add_word(part, end)
            case "unit":
                for k, word in enumerate(self.language.units[text].split()):
                    self.between += [" "] if k or not self.between else []
                    self._add_word(word, end)
            case "tag":
                self._take_tag(text)
            case "stars":
                self.is_stressed = not self.is_stressed
            case "emoticon":
                self.feelings.append((max(len(self.kinds) - (not self._is_open()), 0), self.language.emoticons[text]))
            case "ellipsis" | "dash":
                self.silence += ELLIPSIS_PAUSE if kind == "ellipsis" else DASH_PAUSE
                self.between.append("... " if kind == "ellipsis" else ", ")
                self.is_phrase_over = True
            case "stop":
                self._stop(text)
            case "comma" if text == self.language.question_mark:
                self._stop(text)
            case _:
                self.between.append(" " if text.isspace() else text)
                self.is_phrase_over |= kind == "comma" or text in QUOTATION_SIGNS

    def passage(self) -> Passage:
        """Return the passage of all processed tokens."""
        if self._is_open():
            self.kinds.append(self._classify_sentence(""))
        last = max(len(self.kinds) - 1, 0)
        feelings = tuple((min(sentence, last), feeling) for sentence, feeling in self.feelings if self.kinds)
        tail = " ".join("".join(self.between).split())
        is_over = self.is_phrase_over or not self.words
        directions = tuple(self.directions)
        return Passage(
            tuple(self.words),
            tuple(self.kinds),
            tail,
            self.silence,
            feelings,
            self.language.tag,
            is_over,
            directions,
            self.language.voice,
        )

    def _take_tag(self, tag: str) -> None:
        """Process the tag of a stage direction, emphasis, prosody or break.

        Other tags are a space.
        """
        match = _TAG_PATTERN.match(tag)
        is_end, name = (bool(match[1]), match[2]) if match else (False, "")
        if name == "break" and not is_end and (time := _TIME_PATTERN.search(tag)):
            self.silence += min(float(time[1]) / (1000 if time[2] == "ms" else 1), LONGEST_BREAK)
            self.is_phrase_over = True
        elif name == DIRECTION_TAG and (words := _WORDS_ATTRIBUTE.search(tag)):
            self.directions.append((len(self.words), words[1]))
        elif name.lower() == "emphasis":
            self.is_stressed = not is_end
        elif name in (PROSODY_TAG, VOICE_TAG):
            self.prosody = take_tag(self.prosody, name, tag, is_end=is_end)
        else:
            self.between.append(" ")

    def _is_open(self) -> bool:
        """Return whether the sentence of the last word has not ended."""
        return bool(self.words) and self.words[-1].sentence == len(self.kinds)

    def _add_word(self, text: str, end: int) -> None:
        plain = text.replace("\u2019", "'").lower()
        if ARMENIAN_QUESTION_MARK in plain:
            self.asked = len(self.kinds)
        is_capital = len(text) >= MIN_CAPITALS and text.isupper() and "." not in text and not self.is_shouted
        before = self.words[-1].plain if self.words and self._is_open() else ""
        if self.language.has("numbered", plain) and re.match(r"\. ?\d", self.following):
            text, plain = self.language.number_word or text, f"{plain}."
        named = self.words[-1].text if before else ""
        acronym = read_numeral(text, named, self.language) if text.isupper() and named else ""
        if is_capital and not acronym:
            acronym = read_acronym(text, before, self.following, self.language)
        is_loud = is_capital and not acronym
        word = Word(
            text=acronym or (text.lower() if is_loud or (self.is_shouted and len(text) > 1) else text),
            plain=".".join(plain) if acronym and self.language.knows(plain) else plain,
            before=re.sub(r"\s+", " ", "".join(self.between)),
            sentence=len(self.kinds),
            phrase=self._next_phrase_index(plain),
            is_content=bool(acronym) or not self.language.has("function", plain),
            emphatic=is_loud or self.is_stressed,
            pause=self.silence,
            end=end,
            language=self.language.tag,
            prosody=self.prosody,
        )
        self.words.append(word)
        self.between, self.silence, self.is_phrase_over = [], 0.0, False

    def _next_phrase_index(self, plain: str) -> int:
        """Return the phrase number of the next word.

        A conjunction begins a new phrase if the last one has enough words.
        """
        if not self.words:
            return 0
        last = self.words[-1].phrase
        size = sum(word.phrase == last for word in self.words[-MIN_PHRASE_LENGTH:])
        begins = self.language.has("conjunction", plain) and size == MIN_PHRASE_LENGTH
        return last + (self.is_phrase_over or begins)

    def _stop(self, text: str) -> None:
        last = self.words[-1].plain if self.words else ""
        if not last.endswith("."):
            self.between.append(text)
        is_short = self.language.has("abbreviation", last) or self._is_initial()
        if self.language.has("numbered", last):
            is_short = False
        elif "." in last:  # ends a sentence only before a capital letter
            is_known = last.endswith(".") or self.language.has("abbreviation", last)
            is_short = is_known or not self.following.lstrip()[:1].isupper()
        if text == "." and (is_short or not self._is_open()):
            return
        if self._is_open():
            self.kinds.append(self._classify_sentence(text))
        elif self.kinds and self._classify_sentence(text) == "question":
            self.kinds[-1] = "question"
        self.is_phrase_over = True

    def _is_initial(self) -> bool:
        """Return whether the last word is one letter, as in `J. Smith`."""
        if not self.words or len(self.words[-1].plain) != 1 or not self.words[-1].plain.isalpha():
            return False
        word = self.words[-1]
        return word.plain != "i" and (word.text.isupper() or not self.language.has("function", word.plain))

    def _classify_sentence(self, stop: str) -> SentenceKind:
        """Return the kind of a sentence from its punctuation or last word.

        The last word counts in languages that mark questions by it.
        """
        is_marked = not set(stop).isdisjoint(f"{QUESTION_MARKS}{self.language.question_mark}")
        if is_marked or self.asked == len(self.kinds) or self.language.has("question_end", self.words[-1].plain):
            return "question"
        return "statement" if set(stop).isdisjoint(EXCLAMATION_MARKS) else "exclamation"
