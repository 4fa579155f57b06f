"""XML text as a small frozen tree that knows the line and column of every start tag.

expat is used as it is, without namespaces: undeclared prefixes occur in the field and are taken by name.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import NoReturn
from xml.parsers import expat

from kinesic.bml.block import BOUNDS, BmlError, Bounds, Place, refusal
from kinesic.bml.reading.prologue import first_tag

ONE_BLOCK = (
    "a document is one block: perform each <bml> as a document of its own, or send them one after another to "
    'kinesic serve, where one with composition="APPEND" begins when those before it have ended'
)  # remedy


@dataclass(frozen=True)
class Element:
    """One element as written."""

    name: str  # with its prefix
    attributes: Mapping[str, str]  # name with prefix -> value
    content: tuple["Element | str", ...]
    place: Place  # of the start tag
    scope: Mapping[str, str]  # prefix -> namespace, "" for the default
    called: str = ""  # as written, where the name is another dialect's in words of BML

    @property
    def written(self) -> str:
        """Name as the document has it."""
        return self.called or self.name

    @property
    def local(self) -> str:
        """Name without prefix."""
        return self.name.rpartition(":")[2]

    @property
    def children(self) -> tuple["Element", ...]:
        """Elements inside, without the text between them."""
        return tuple(piece for piece in self.content if isinstance(piece, Element))

    def reword(self, name: str | None = None, *without: str, **attributes: str | None) -> "Element":
        """Returns a copy with another name, some attributes removed and others added.

        Args:
            name: of the new element; None: the same.
            without: names of attributes that are left out.
            attributes: that are added or replaced; None takes one away.
        """
        kept = {key: value for key, value in self.attributes.items() if key not in without} | attributes
        left = {key: value for key, value in kept.items() if value is not None}
        return replace(self, name=name or self.name, attributes=MappingProxyType(left), called=self.written)

    @property
    def text(self) -> str:
        """All text inside, that of inner elements included, as written."""
        return "".join(piece if isinstance(piece, str) else piece.text for piece in self.content)


@dataclass
class _Open:
    """An element whose end tag has not come yet."""

    name: str
    attributes: dict[str, str]
    place: Place
    scope: Mapping[str, str]
    content: list[Element | str] = field(default_factory=list)

    def close(self) -> Element:
        return Element(self.name, MappingProxyType(self.attributes), tuple(self.content), self.place, self.scope)


class _Builder:
    """Collects what expat reports, and refuses what is too deep or declares entities."""

    def __init__(self, source: str, bounds: Bounds, encoding: str | None, around: str) -> None:
        self.root: Element | None = None
        self._source, self._bounds, self._around = source, bounds, around
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
        return self.placed(self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber)

    def placed(self, line: int, offset: int) -> Place:
        """A place in the text itself, by line from 1 and characters from 0 as expat counts them."""
        return Place(line, max(1, offset + 1 - (len(self._around) if line == 1 else 0)))

    def parse(self, text: bytes) -> None:
        """Reads the whole text, inside an element of our own where one is to be thought around it."""
        if self._around:
            self.parser.Parse(self._around.encode(), False)
            self.parser.Parse(text, False)
            text = self._around.replace("<", "</").encode()
        self.parser.Parse(text, True)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        if len(self._open) == self._bounds.depth:
            raise refusal(
                self._source,
                self.place,
                f"<{name}> is the {self._bounds.depth + 1}th element inside one another",
                f"at most {self._bounds.depth} are read",
            )
        self._count += 1
        if self._count > self._bounds.elements:
            what = f"more than {self._bounds.elements} elements"
            raise refusal(self._source, self.place, what, "split the document")
        outer = self._open[-1].scope if self._open else MappingProxyType({"": ""})
        self._open.append(_Open(name, attributes, self.place, _scope(outer, attributes)))

    def _end(self, name: str) -> None:
        element = self._open.pop().close()
        if self._open:
            self._open[-1].content.append(element)
        else:
            self.root = element

    def _text(self, text: str) -> None:
        self._open[-1].content.append(text)

    def _entity_declared(self, name: str, *_: object) -> NoReturn:
        raise refusal(
            self._source, self.place, f"declares the entity {name}", "write the text itself; entities are not read"
        )

    def _entity_skipped(self, name: str, is_parameter: bool) -> None:
        if not is_parameter:
            raise refusal(
                self._source, self.place, f"uses the unknown entity &{name};", "write the character itself, or &#...;"
            )


def _is_second_block(behind: bytes) -> bool:
    """Whether another <bml> begins behind a document's end, maybe with a declaration of its own."""
    return first_tag(behind.decode("utf-8", errors="replace")) == "bml"


def _scope(outer: Mapping[str, str], attributes: Mapping[str, str]) -> Mapping[str, str]:
    declared = {name[6:]: uri for name, uri in attributes.items() if name == "xmlns" or name.startswith("xmlns:")}
    return MappingProxyType({**outer, **declared}) if declared else outer


def read_tree(text: str | bytes, *, source: str, bounds: Bounds = BOUNDS, around: str = "") -> Element:
    """Reads a document.

    Bytes are decoded as their XML declaration says; a `str` is taken as it is, whatever it declares.

    Args:
        text: the document.
        source: its name, for messages.
        bounds: largest size and depth; the size is checked before anything is read.
        around: name of an element that is thought around the text, which then may be a row of elements.

    Raises:
        BmlError: too large, too deep, empty, not well-formed, or with entities.
    """
    start = Place(1, 1)
    if len(text) > bounds.size:
        raise refusal(
            source, start, f"the document has {len(text)} characters", f"at most {bounds.size} are read: split it"
        )
    if not text.strip():
        raise refusal(source, start, "the document is empty", "a <bml> element is expected")
    builder = _Builder(source, bounds, "utf-8" if isinstance(text, str) else None, around and f"<{around}>")
    try:
        written = text.encode("utf-8") if isinstance(text, str) else text
        builder.parse(written)
    except expat.ExpatError as error:
        place = builder.placed(error.lineno, error.offset)
        if builder.root is not None and _is_second_block(written[builder.parser.ErrorByteIndex :]):
            raise refusal(source, place, "a second <bml> behind the first", ONE_BLOCK) from None
        raise refusal(source, place, f"not XML: {expat.ErrorString(error.code)}", "well-formed XML is needed") from None
    except UnicodeEncodeError as error:
        what = f"character {error.start} is no character of Unicode"
        raise refusal(source, start, what, "remove the lone surrogate") from None
    except BmlError:
        raise
    except (LookupError, ValueError) as error:
        raise refusal(source, start, f"its encoding cannot be read: {error}", "save it as UTF-8") from None
    if builder.root is None:
        raise refusal(source, start, "the document has no element", "a <bml> element is expected")
    return builder.root
