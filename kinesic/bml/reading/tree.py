"""Parsing of XML into an immutable tree with source positions.

expat runs without namespace processing, since documents in use have undeclared prefixes; these are kept in the names.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import NoReturn
from xml.parsers import expat

from kinesic.bml.block import DEFAULT_BOUNDS, BmlError, DocumentBounds, Place, document_error
from kinesic.bml.reading.prologue import find_first_tag

ONE_BLOCK_REMEDY = (
    "a document is one block: perform each <bml> as a separate document, or send them one after another to "
    'kinesic serve, where a block with composition="APPEND" starts when those before it have ended'
)  # remedy in the error message for several <bml>


@dataclass(frozen=True)
class Element:
    """Immutable XML element with its place in the document."""

    name: str  # element name with prefix
    attributes: Mapping[str, str]  # name with prefix -> value
    content: tuple["Element | str", ...]
    place: Place  # place of the start tag
    scope: Mapping[str, str]  # prefix -> namespace, "" for the default
    original_tag: str = ""  # name in the document if `name` is its translation into BML

    @property
    def tag(self) -> str:
        """Element name in the document, before any translation."""
        return self.original_tag or self.name

    @property
    def local(self) -> str:
        """Element name without its prefix."""
        return self.name.rpartition(":")[2]

    @property
    def children(self) -> tuple["Element", ...]:
        """Child elements, without the text between them."""
        return tuple(piece for piece in self.content if isinstance(piece, Element))

    def reword(self, name: str | None = None, *without: str, **attributes: str | None) -> "Element":
        """Return a copy with another name and changed attributes.

        Args:
            name: new name; None: unchanged.
            without: names of attributes to remove.
            attributes: attributes to add or replace; None removes one.
        """
        merged = {key: value for key, value in self.attributes.items() if key not in without} | attributes
        present = {key: value for key, value in merged.items() if value is not None}
        return replace(self, name=name or self.name, attributes=MappingProxyType(present), original_tag=self.tag)

    @property
    def text(self) -> str:
        """Text of the element and of all nested elements."""
        return "".join(piece if isinstance(piece, str) else piece.text for piece in self.content)


@dataclass
class _Open:
    """XML element whose end tag has not been read."""

    name: str
    attributes: dict[str, str]
    place: Place
    scope: Mapping[str, str]
    content: list[Element | str] = field(default_factory=list)

    def close(self) -> Element:
        return Element(self.name, MappingProxyType(self.attributes), tuple(self.content), self.place, self.scope)


class _Builder:
    """Builder of an `Element` tree from expat's events.

    Rejects deep nesting and entities.
    """

    def __init__(self, source: str, bounds: DocumentBounds, encoding: str | None, wrapper: str) -> None:
        self.root: Element | None = None
        self._source, self._bounds, self._wrapper = source, bounds, wrapper
        self._open: list[_Open] = []
        self._count = 0
        self.parser = expat.ParserCreate(encoding)
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.EntityDeclHandler = self._entity_declared
        self.parser.SkippedEntityHandler = self._entity_skipped

    @property
    def place(self) -> Place:
        return self.locate(self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber)

    def locate(self, line: int, offset: int) -> Place:
        """Convert expat's position to a place in the original text.

        Args:
            line: line from 1.
            offset: characters from 0, as counted by expat.
        """
        return Place(line, max(1, offset + 1 - (len(self._wrapper) if line == 1 else 0)))

    def parse(self, text: bytes) -> None:
        """Parse the whole text, inside the optional wrapper element."""
        if self._wrapper:
            self.parser.Parse(self._wrapper.encode(), False)
            self.parser.Parse(text, False)
            text = self._wrapper.replace("<", "</").encode()
        self.parser.Parse(text, True)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        if len(self._open) == self._bounds.depth:
            raise document_error(
                self._source,
                self.place,
                f"<{name}> is nested {self._bounds.depth + 1} levels deep",
                f"the limit is {self._bounds.depth} levels",
            )
        self._count += 1
        if self._count > self._bounds.elements:
            problem = f"more than {self._bounds.elements} elements"
            raise document_error(self._source, self.place, problem, "split the document")
        outer = self._open[-1].scope if self._open else MappingProxyType({"": ""})
        self._open.append(_Open(name, attributes, self.place, _extend_scope(outer, attributes)))

    def _end(self, name: str) -> None:
        element = self._open.pop().close()
        if self._open:
            self._open[-1].content.append(element)
        else:
            self.root = element

    def _text(self, text: str) -> None:
        self._open[-1].content.append(text)

    def _entity_declared(self, name: str, *_: object) -> NoReturn:
        raise document_error(
            self._source, self.place, f"declares the entity {name}", "write the text itself; entities are not supported"
        )

    def _entity_skipped(self, name: str, is_parameter: bool) -> None:
        if not is_parameter:
            raise document_error(
                self._source, self.place, f"uses the unknown entity &{name};", "write the character itself, or &#...;"
            )


def _starts_second_block(behind: bytes) -> bool:
    """Return whether another <bml> starts behind the end of a document.

    A second XML declaration may precede it.
    """
    return find_first_tag(behind.decode("utf-8", errors="replace")) == "bml"


def _extend_scope(outer: Mapping[str, str], attributes: Mapping[str, str]) -> Mapping[str, str]:
    declared = {name[6:]: uri for name, uri in attributes.items() if name == "xmlns" or name.startswith("xmlns:")}
    return MappingProxyType({**outer, **declared}) if declared else outer


def read_tree(text: str | bytes, *, source: str, bounds: DocumentBounds = DEFAULT_BOUNDS, wrapper: str = "") -> Element:
    """Parse an XML document.

    Bytes are decoded as their XML declaration says; a `str` is used unchanged, and its declaration is ignored.

    Args:
        text: the document.
        source: name of the document, for messages.
        bounds: maximum size and depth; the size is checked before parsing.
        wrapper: name of an element to put around the text, which then may be a sequence of elements.

    Raises:
        BmlError: too large, too deep, empty, not well-formed, or with entities.
    """
    start = Place(1, 1)
    if len(text) > bounds.size:
        raise document_error(
            source, start, f"the document has {len(text)} characters", f"the limit is {bounds.size}: split it"
        )
    if not text.strip():
        raise document_error(source, start, "the document is empty", "a <bml> element is expected")
    builder = _Builder(source, bounds, "utf-8" if isinstance(text, str) else None, wrapper and f"<{wrapper}>")
    try:
        data = text.encode("utf-8") if isinstance(text, str) else text
        builder.parse(data)
    except expat.ExpatError as error:
        place = builder.locate(error.lineno, error.offset)
        if builder.root is not None and _starts_second_block(data[builder.parser.ErrorByteIndex :]):
            raise document_error(source, place, "a second <bml> behind the first", ONE_BLOCK_REMEDY) from None
        raise document_error(
            source, place, f"not XML: {expat.ErrorString(error.code)}", "write well-formed XML"
        ) from None
    except UnicodeEncodeError as error:
        problem = f"character {error.start} is not a Unicode character"
        raise document_error(source, start, problem, "remove the lone surrogate") from None
    except BmlError:
        raise
    except (LookupError, ValueError) as error:
        raise document_error(source, start, f"its encoding is not supported: {error}", "save it as UTF-8") from None
    if builder.root is None:
        raise document_error(source, start, "the document has no element", "a <bml> element is expected")
    return builder.root
