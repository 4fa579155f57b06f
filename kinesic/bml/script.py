"""The text of a speech with its marks: plain, with `sync`, with Greta's `tm`, or as SSML with `mark`."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from kinesic.bml.block import NoticeType
from kinesic.bml.reading import Named, Reading
from kinesic.bml.tree import Element
from kinesic.body.utterance import Mark, Script

MARKS = frozenset({"sync", "tm", "mark"})
PROSODY = frozenset({"pitchaccent", "boundary"})
SSML = "application/ssml+xml"

_LANGUAGES = {
    "english": "en",
    "french": "fr",
    "german": "de",
    "italian": "it",
    "japanese": "ja",
    "portuguese": "pt",
    "spanish": "es",
}


@dataclass(frozen=True)
class _Mark:
    name: str


def script_of(named: Named, reading: Reading) -> Script:
    """Reads what a <speech> says.

    A description in SSML goes before the text when its priority is not negative; other descriptions are passed over.
    """
    body = _body(named.element)
    text, marks, unusable = "", dict[str, int](), list[str]()
    for piece in _pieces(body, outermost=True):
        if isinstance(piece, str):
            spaced = re.sub(r"\s+", " ", piece)
            text += spaced.lstrip() if not text or text.endswith(" ") else spaced
        elif not piece.name or piece.name in ("start", "end") or piece.name in marks:
            unusable.append(piece.name)
        else:
            marks[piece.name] = len(text)
    if unusable:
        what = f"marks without a name of their own are passed over: {', '.join(map(repr, unusable))}"
        reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
    text = text.rstrip() or " ".join(named.word("text").split())
    places = tuple(Mark(name, min(position, len(text))) for name, position in marks.items())
    return Script(text, places, _language(named))


def _body(speech: Element) -> Element:
    """The element whose content is said."""
    inside = {child.local: child for child in speech.children}
    for child in speech.children:
        is_ssml = child.local == "description" and child.attributes.get("type", "").strip() == SSML
        if is_ssml and not child.attributes.get("priority", "").strip().startswith("-"):
            return child
    return inside.get("text", speech)


def _pieces(element: Element, *, outermost: bool) -> Iterator[str | _Mark]:
    for piece in element.content:
        if isinstance(piece, str):
            yield piece
        elif piece.local in MARKS:
            yield _Mark((piece.attributes.get("id") or piece.attributes.get("name") or "").strip())
        elif not outermost or element.local != "speech":
            yield from _pieces(piece, outermost=False)


def _language(named: Named) -> str:
    written = (named.attributes.get("language") or named.element.attributes.get("xml:lang") or "en").strip().lower()
    return _LANGUAGES.get(written, written)
