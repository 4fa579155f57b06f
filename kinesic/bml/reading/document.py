"""From text to the tree of a document, in whatever notation: XML, a fragment of it, or JSON."""

from collections.abc import Iterator
from dataclasses import dataclass

from kinesic.bml.block import BOUNDS, Bounds, Dialect, refusal
from kinesic.bml.reading.dialect_words import fold_capitals
from kinesic.bml.reading.elements import ACTIONS
from kinesic.bml.reading.fragments import is_fragment, read_fragments
from kinesic.bml.reading.json_notation import is_json, read_json
from kinesic.bml.reading.namespaces import BML_1_0, DRAFTS, namespace
from kinesic.bml.reading.prologue import first_tag
from kinesic.bml.reading.tree import ONE_BLOCK, Element, read_tree

_ROOTS = ("bml", "fml-apml")
_MARKED = (b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff")  # byte order marks


@dataclass(frozen=True)
class Document:
    """A document with its one <bml>."""

    root: Element
    bml: Element
    dialect: Dialect
    in_capitals: tuple[str, ...] = ()  # names of elements that are read as if they were small
    text: str = ""  # as it was read; empty where it is not UTF-8


def read_document(text: str | bytes, *, source: str, bounds: Bounds = BOUNDS) -> Document:
    """Reads a document and finds its <bml>.

    Args:
        text: bytes are decoded as their XML declaration says, fragments and JSON as UTF-8.
        source: its name, for messages.
        bounds: largest size and depth.

    Raises:
        BmlError: broken, too large, too deep, or with none or several <bml>.
    """
    plain = _plain(text) if len(text) <= bounds.size else None
    if plain is not None and is_json(plain):
        root = read_json(plain, source=source, bounds=bounds)
        return Document(root, root, "json", text=plain)
    if plain is not None and is_fragment(plain, frozenset(ACTIONS)):
        root = read_fragments(plain, source=source, bounds=bounds)
        return Document(root, root, "smartbody", text=plain)
    root = read_tree(text, source=source, bounds=bounds)
    folded: set[str] = set()
    root = fold_capitals(root, folded)
    bml = _only_bml(root, source)
    return Document(root, bml, _dialect(root, namespace(bml)), tuple(sorted(folded)), plain or "")


def begins_as_bml(start: bytes) -> bool:
    """Checks whether a file's first bytes are those of a <bml> or an FML-APML document, whatever its ending is."""
    return first_tag(start.decode("utf-8", errors="replace").removeprefix("\ufeff")) in _ROOTS


def _plain(text: str | bytes) -> str | None:
    """The text; None when it is not UTF-8, and so can only be XML."""
    if isinstance(text, str):
        return text
    if text.startswith(_MARKED[1:]):
        return None
    try:
        return text.removeprefix(_MARKED[0]).decode("utf-8")
    except UnicodeDecodeError:
        return None


def _only_bml(root: Element, source: str) -> Element:
    found = list(_every_bml(root))
    if not found:
        raise refusal(source, root.place, f"<{root.name}> holds no <bml>", "a <bml> element is expected")
    if len(found) > 1:
        what = f"a second <bml>: <{root.name}> holds {len(found)}"
        raise refusal(source, found[1].place, what, ONE_BLOCK)
    return found[0]


def _every_bml(element: Element) -> Iterator[Element]:
    if element.local == "bml":
        yield element
        return
    for child in element.children:
        yield from _every_bml(child)


def _dialect(root: Element, home: str | None) -> Dialect:
    if root.local == "fml-apml":
        return "fml-apml"
    if home == BML_1_0:
        return "bml-1.0"
    return "draft" if home in DRAFTS else "none"
