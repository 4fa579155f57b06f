"""Conversion of speech scripts to SSML."""

import re
import unicodedata
from collections.abc import Collection
from io import StringIO
from typing import TYPE_CHECKING
from xml.sax.xmlreader import AttributesImpl

from kinesic.body.pictographs import blank_pictographs
from kinesic.body.utterance import Emphasis, Mark, Script

if TYPE_CHECKING:
    from xml.sax.saxutils import XMLGenerator

_FORBIDDEN_PATTERN = re.compile(
    "[\x00-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]"
)  # characters without a sound or not allowed in XML
_FULL_STOP = re.compile(r"\.\s*$")
_STOP_PATTERN = re.compile(r"[.!?\u2026]+(?![\w.!?\u2026])")  # stops that end a sentence
# Stop between two words without a space.
_UNSPACED_STOP = re.compile(r"(?<=[^\W\d_])[!?:;]+(?=[^\W\d_]{2})|(?<=[a-z]{2})\.(?=[A-Z][a-z])")
_INNER_SIGNS = str.maketrans("", "", "'\u2019-")  # signs that may occur within a word
_WORD_CATEGORIES = frozenset(("Lu", "Ll", "Lt", "Lm", "Lo", "Mn", "Mc", "Nd"))  # letters, combining marks, digits


def write_ssml(script: Script) -> str:
    """Write a speech script as an SSML <speak> element.

    Marks are named by their index in `script.stops()`, so that any name works, even twice. A line break separates a
    full stop from a following element, because espeak-ng 1.52 skips elements between a full stop and a capital letter.
    Pictographs are omitted, because espeak-ng reads their names.
    """
    from xml.sax.saxutils import XMLGenerator  # noqa: PLC0415 - imports web clients, which few programs need

    output = StringIO()
    writer = XMLGenerator(output, encoding="utf-8", short_empty_elements=True)
    text = blank_pictographs(_FORBIDDEN_PATTERN.sub(" ", script.text))
    stops = list(enumerate(script.stops()))
    pending = sorted((e for e in script.emphases if e.begin < e.end), key=lambda e: (e.begin, -e.end))
    positions = {0, len(text), *(stop.position for _, stop in stops)}
    positions |= {position for emphasis in pending for position in (emphasis.begin, emphasis.end)}
    characters = _separate_stops(text, positions)
    open_elements: list[Emphasis] = []
    written_up_to = 0
    writer.startElement("speak", AttributesImpl({}))
    for position in sorted(min(max(position, 0), len(text)) for position in positions):
        written = "".join(characters[written_up_to:position])
        writer.characters(written + ("\n" if _is_swallowed(text, position) and not written.endswith("\n") else ""))
        written_up_to = position
        while open_elements and open_elements[-1].end <= position:
            writer.endElement(open_elements.pop().element)
        while stops and stops[0][1].position <= position:
            number, stop = stops.pop(0)
            if isinstance(stop, Mark):
                _write_empty(writer, "mark", {"name": str(number)})
            else:
                _write_empty(writer, "break", {"time": f"{round(1000 * stop.duration)}ms"})
        while pending and pending[0].begin <= position:
            open_elements.append(pending.pop(0))
            writer.startElement(open_elements[-1].element, AttributesImpl(dict(open_elements[-1].attributes)))
    for emphasis in reversed(open_elements):
        writer.endElement(emphasis.element)
    writer.endElement("speak")
    return output.getvalue()


def _separate_stops(text: str, boundaries: Collection[int]) -> list[str]:
    """Return characters, with line breaks after stops separated from their words.

    espeak-ng 1.52 reads a stop aloud ("dot") that an element, a quote, a bracket or a sign separates from its word,
    and the last one after a word with a sign (`and/or.`), unless a line ends after it. It also names a stop between
    two words without a space, so a space is added. A stop without a word since the preceding stop is omitted.

    Args:
        text: text to speak.
        boundaries: positions of SSML elements.
    """
    characters = list(text)
    for match in _UNSPACED_STOP.finditer(text):
        characters[match.end() - 1] += " "
    last = text.rstrip().rpartition(" ")[2].rstrip(".!?\u2026").translate(_INNER_SIGNS)
    has_sign_at_end = any(unicodedata.category(character) not in _WORD_CATEGORIES for character in last)
    end_of_stop = -1  # end of the preceding stop
    for match in _STOP_PATTERN.finditer(text):
        begin, end = match.span()
        is_separated = begin in boundaries or not (begin and _is_letter(text[begin - 1]))
        is_separated |= has_sign_at_end and not text[end:].strip()
        if end_of_stop >= 0 and not any(map(_is_letter, text[end_of_stop:begin])):
            characters[begin:end] = " " * (end - begin)
        elif is_separated or any(position in boundaries for position in range(begin + 1, end)):
            characters[begin:end] = [*text[begin : end - 1], text[end - 1] + "\n"]
        end_of_stop = end
    return characters


def _is_letter(character: str) -> bool:
    return unicodedata.category(character)[0] in "LMN"


def _is_swallowed(text: str, position: int) -> bool:
    """Return whether espeak-ng would skip an SSML element at a position.

    A decimal point is not a full stop.
    """
    first = text[position:].lstrip()[:1]
    is_decimal = first.isdigit() and text[position - 1 : position + 1] == f".{first}"
    return bool(first and _FULL_STOP.search(text[:position])) and not (first.islower() or is_decimal)


def _write_empty(writer: "XMLGenerator", name: str, attributes: dict[str, str]) -> None:
    writer.startElement(name, AttributesImpl(attributes))
    writer.endElement(name)
