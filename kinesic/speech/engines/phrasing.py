"""Division of a speech script into phrases and silences.

An engine gets one phrase at a time: at most a sentence, cut where the script has a pause. A longer pause for the body
therefore changes nothing but the silence.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from kinesic.body.scripts import PHRASE_STOPS, SENTENCE_STOPS
from kinesic.body.utterance import Script
from kinesic.speech.durations import PHRASE_PAUSE, SENTENCE_PAUSE
from kinesic.speech.engines.phrase import Phrase, ProsodySection
from kinesic.speech.engines.prosody_factors import convert_sections

MAX_PHRASE_LENGTH = 300  # [characters] longest phrase; longer sentences are cut at a comma or a space
# months, whose full stop ends no sentence
MONTH_ABBREVIATIONS = frozenset({"Jan", "Feb", "Mar", "Apr", "Jun", "Jul", "Aug", "Sep", "Sept", "Oct", "Nov", "Dec"})
TITLE_ABBREVIATIONS = frozenset(  # words before a name or number, whose full stop ends no sentence
    {
        "Capt",
        "Col",
        "Dr",
        "Fig",
        "Gen",
        "Jr",
        "Lt",
        "Mr",
        "Mrs",
        "Ms",
        "Mt",
        "No",
        "Prof",
        "Rev",
        "Sgt",
        "Sr",
        "St",
        "vs",
    }
)
CONTINUATION_SIGN = ","  # added to a phrase cut inside a sentence, against a final fall of pitch
CLOSING_SIGNS = "\"'\u2019\u201d\u00bb)\\]"  # signs between a stop and the space after it

_SENTENCE_END = re.compile(rf"[{SENTENCE_STOPS}]+[{CLOSING_SIGNS}]*(?=\s)")
_CLAUSE_END = re.compile(rf"[{PHRASE_STOPS}](?=\s)")
_FINAL_STOP = re.compile(rf"[{SENTENCE_STOPS}{PHRASE_STOPS}][{CLOSING_SIGNS}]*$")
_LAST_WORD = re.compile(r"[\w.]*$")
_WORD_PATTERN = re.compile(r"\w+(?:['\u2019]\w+)*")


@dataclass(frozen=True)
class PlacedPhrase:
    """Phrase with its place in a script, and the silence before it."""

    phrase: Phrase
    begin: int  # position of the phrase's first character in the script
    silence: float  # [s] silence before the phrase, from the end of the preceding phrase or the start


def divide(script: Script, *, rate: float, pitch: float) -> tuple[tuple[PlacedPhrase, ...], float]:
    """Divide a script into phrases, and return the final silence [s].

    A silence has the longest duration that the script or a sentence's end requires. Pauses do not depend on the rate.

    Args:
        script: text to say.
        rate: 1 is normal.
        pitch: 1 is normal.
    """
    sections = convert_sections(script.emphases)
    pauses = [(_after_word(script.text, pause.position), pause.duration) for pause in script.pauses]
    cuts = sorted({0, len(script.text), *_sentence_ends(script.text), *(position for position, _ in pauses)})
    placed: list[PlacedPhrase] = []
    requested, punctuation = 0.0, 0.0  # [s] silence since the last word
    for begin, end in pairwise(cuts):
        requested += sum(duration for position, duration in pauses if position == begin)
        text = script.text[begin:end]
        if not _has_word(text):
            continue
        for first, last in _shorten(text):
            silence = max(requested, punctuation / rate if placed else 0.0)
            placed.append(_place(script, (begin + first, begin + last), silence, sections, rate, pitch))
            requested, punctuation = 0.0, 0.0
        punctuation = _final_silence(text)
    requested += sum(duration for position, duration in pauses if position == cuts[-1])
    return tuple(placed), requested


def is_closed(text: str) -> bool:
    """Return whether a text ends with sentence or phrase punctuation."""
    return _FINAL_STOP.search(text.rstrip()) is not None


def _place(
    script: Script,
    span: tuple[int, int],
    silence: float,
    sections: tuple[ProsodySection, ...],
    rate: float,
    pitch: float,
) -> PlacedPhrase:
    """Return the phrase between two positions of a script."""
    begin, end = span
    text = script.text[begin:end].rstrip()
    begin += len(text) - len(text.lstrip())
    text = text.lstrip()
    clipped = tuple(
        ProsodySection(
            max(section.begin - begin, 0),
            min(section.end - begin, len(text)),
            section.rate,
            section.pitch,
            section.volume,
        )
        for section in sections
        if section.begin < begin + len(text) and section.end > begin
    )
    is_last = not _has_word(script.text[end:])
    text += "" if is_last or is_closed(text) else CONTINUATION_SIGN
    return PlacedPhrase(Phrase(text, script.language, rate, pitch, clipped), begin, silence)


def _sentence_ends(text: str) -> Iterator[int]:
    """Yield the positions after sentences, but not after titles and initials."""
    for match in _SENTENCE_END.finditer(text):
        following = text[match.end() :].lstrip()[:1]
        word = _LAST_WORD.search(text[: match.start()])
        last = word[0] if word else ""
        is_abbreviated = match[0] == "." and (_is_abbreviation(last))
        if following and not following.islower() and not is_abbreviated:
            yield match.end()


def _is_abbreviation(word: str) -> bool:
    """Return whether a word is a title, a month or an initial."""
    is_initial = len(word) == 1 and word.isupper() and word != "I"
    return is_initial or word in TITLE_ABBREVIATIONS or word in MONTH_ABBREVIATIONS


def _shorten(text: str) -> Iterator[tuple[int, int]]:
    """Yield begin and end of parts of at most `MAX_PHRASE_LENGTH`."""
    begin = 0
    while len(text) - begin > MAX_PHRASE_LENGTH:
        window = text[begin : begin + MAX_PHRASE_LENGTH]
        ends = [match.end() for match in _CLAUSE_END.finditer(window)]
        cut = begin + (ends[-1] if ends else window.rfind(" ") + 1 or len(window))
        if _has_word(text[begin:cut]) and _has_word(text[cut:]):
            yield begin, cut
        elif not _has_word(text[cut:]):
            break
        begin = cut
    yield begin, len(text)


def _after_word(text: str, position: int) -> int:
    """Move a position inside a word to the end of the word."""
    position = min(max(position, 0), len(text))
    for match in _WORD_PATTERN.finditer(text, max(text.rfind(" ", 0, position), 0)):
        if match.start() >= position:
            break
        if match.end() > position:
            return match.end()
    return position


def _final_silence(text: str) -> float:
    """Return the silence [s] after a text, by its final punctuation."""
    stop = _FINAL_STOP.search(text.rstrip())
    if stop is None:
        return 0.0
    return SENTENCE_PAUSE if stop[0][0] in SENTENCE_STOPS else PHRASE_PAUSE


def _has_word(text: str) -> bool:
    return any(character.isalnum() for character in text)
