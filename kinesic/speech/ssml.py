"""A script as SSML, written so that an engine reads exactly what was meant."""

import re
from io import StringIO
from typing import TYPE_CHECKING
from xml.sax.xmlreader import AttributesImpl

from kinesic.body.utterance import Emphasis, Mark, Script

if TYPE_CHECKING:
    from xml.sax.saxutils import XMLGenerator

_FORBIDDEN = re.compile("[\x00-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")  # in XML, or of no sound
_FULL_STOP = re.compile(r"\.\s*$")


def ssml(script: Script) -> str:
    """Writes a script as a <speak> element.

    Marks are called by their number among `script.stops()`, so that any name, and any name twice, comes through.
    Between a full stop and an element there is the end of a line: espeak-ng 1.52 passes over elements that stand
    between a full stop and a capital letter.
    """
    from xml.sax.saxutils import XMLGenerator  # noqa: PLC0415 - brings clients of the web with it, and few scripts speak

    written = StringIO()
    writer = XMLGenerator(written, encoding="utf-8", short_empty_elements=True)
    text = _FORBIDDEN.sub(" ", script.text)
    stops = list(enumerate(script.stops()))
    coming = sorted((e for e in script.emphases if e.begin < e.end), key=lambda e: (e.begin, -e.end))
    places = {0, len(text), *(stop.position for _, stop in stops)}
    places |= {place for emphasis in coming for place in (emphasis.begin, emphasis.end)}
    open_ones: list[Emphasis] = []
    before = 0
    writer.startElement("speak", AttributesImpl({}))
    for place in sorted(min(max(place, 0), len(text)) for place in places):
        writer.characters(text[before:place] + ("\n" if _is_swallowed(text, place) else ""))
        before = place
        while open_ones and open_ones[-1].end <= place:
            writer.endElement(open_ones.pop().element)
        while stops and stops[0][1].position <= place:
            number, stop = stops.pop(0)
            if isinstance(stop, Mark):
                _empty(writer, "mark", {"name": str(number)})
            else:
                _empty(writer, "break", {"time": f"{round(1000 * stop.duration)}ms"})
        while coming and coming[0].begin <= place:
            open_ones.append(coming.pop(0))
            writer.startElement(open_ones[-1].element, AttributesImpl(dict(open_ones[-1].attributes)))
    for emphasis in reversed(open_ones):
        writer.endElement(emphasis.element)
    writer.endElement("speak")
    return written.getvalue()


def _is_swallowed(text: str, place: int) -> bool:
    """Says whether an element would stand between a full stop, no decimal point, and a new sentence."""
    first = text[place:].lstrip()[:1]
    is_decimal = first.isdigit() and text[place - 1 : place + 1] == f".{first}"
    return bool(first and _FULL_STOP.search(text[:place])) and not (first.islower() or is_decimal)


def _empty(writer: "XMLGenerator", name: str, attributes: dict[str, str]) -> None:
    writer.startElement(name, AttributesImpl(attributes))
    writer.endElement(name)
