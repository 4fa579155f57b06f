"""Parsing of XML, XML fragments and JSON into a document tree."""

from collections.abc import Iterator
from dataclasses import dataclass
from types import MappingProxyType

from kinesic.bml.block import DEFAULT_BOUNDS, Dialect, DocumentBounds, document_error
from kinesic.bml.reading.dialect_words import fold_capitals
from kinesic.bml.reading.elements import ACTION_READERS
from kinesic.bml.reading.fragments import is_fragment, read_fragments
from kinesic.bml.reading.json_notation import is_json, read_json
from kinesic.bml.reading.namespaces import BML_1_0, DRAFT_NAMESPACES, find_namespace
from kinesic.bml.reading.prologue import find_first_tag
from kinesic.bml.reading.tree import ONE_BLOCK_REMEDY, Element, read_tree
from kinesic.bml.reading.wrapping import open_document

_ROOT_NAMES = ("bml", "fml-apml")  # root elements of supported documents
_BYTE_ORDER_MARKS = (b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff")  # byte order marks of UTF-8 and UTF-16


@dataclass(frozen=True)
class Document:
    """Document tree with its single <bml>."""

    root: Element
    bml: Element
    dialect: Dialect
    in_capitals: tuple[str, ...] = ()  # element names in capitals, read as lower case
    text: str = ""  # source text; empty if it is not UTF-8
    notes: tuple[str, ...] = ()  # ignored text around the document, and tolerated faults


def read_document(text: str | bytes, *, source: str, bounds: DocumentBounds = DEFAULT_BOUNDS) -> Document:
    """Read a document and find its <bml>.

    Args:
        text: the document; bytes are decoded as their XML declaration says, fragments and JSON as UTF-8.
        source: name of the document, for messages.
        bounds: maximum size and depth.

    Raises:
        BmlError: broken, too large or too deep, or not exactly one <bml>.
    """
    notes: tuple[str, ...] = ()
    if len(text) <= bounds.size:
        opened = open_document(text)
        text, notes = opened.text, opened.surroundings
    plain = _decode_utf8(text) if len(text) <= bounds.size else None
    if plain is not None and is_json(plain):
        root, faults = read_json(plain, source=source, bounds=bounds)
        return Document(root, root, "json", text=plain, notes=(*notes, *faults))
    if plain is not None and is_fragment(plain, frozenset(ACTION_READERS)):
        root = read_fragments(plain, source=source, bounds=bounds)
        return Document(root, root, "smartbody", text=plain, notes=notes)
    root = read_tree(text, source=source, bounds=bounds)
    folded: set[str] = set()
    root = fold_capitals(root, folded)
    bml = _find_single_block(root, source)
    dialect = _find_dialect(root, find_namespace(bml))
    return Document(root, bml, dialect, tuple(sorted(folded)), plain or "", notes)


def is_bml_start(start: bytes) -> bool:
    """Return whether a file starts as BML or FML-APML in XML.

    Args:
        start: first bytes of the file; its name does not matter.
    """
    return find_first_tag(start.decode("utf-8", errors="replace").removeprefix("\ufeff")) in _ROOT_NAMES


def _decode_utf8(text: str | bytes) -> str | None:
    """Return the text decoded as UTF-8, or None.

    A text that is not UTF-8 can only be XML.
    """
    if isinstance(text, str):
        return text
    if text.startswith(_BYTE_ORDER_MARKS[1:]):
        return None
    try:
        return text.removeprefix(_BYTE_ORDER_MARKS[0]).decode("utf-8")
    except UnicodeDecodeError:
        return None


def _find_single_block(root: Element, source: str) -> Element:
    blocks = list(_find_blocks(root))
    if not blocks and root.local == "fml-apml":  # FML alone
        return Element("bml", MappingProxyType({}), (), root.place, root.scope)
    if not blocks:
        raise document_error(source, root.place, f"<{root.name}> contains no <bml>", "a <bml> element is expected")
    if len(blocks) > 1:
        problem = f"a second <bml>: <{root.name}> contains {len(blocks)}"
        raise document_error(source, blocks[1].place, problem, ONE_BLOCK_REMEDY)
    return blocks[0]


def _find_blocks(element: Element) -> Iterator[Element]:
    if element.local == "bml":
        yield element
        return
    for child in element.children:
        yield from _find_blocks(child)


def _find_dialect(root: Element, home: str | None) -> Dialect:
    if root.local == "fml-apml":
        return "fml-apml"
    if home == BML_1_0:
        return "bml-1.0"
    return "draft" if home in DRAFT_NAMESPACES else "none"
