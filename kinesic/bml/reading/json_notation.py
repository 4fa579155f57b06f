"""BML as JSON: the same elements as objects, and the words of web realizers that send it.

A document is a list of behaviours, or an object with `behaviours` (or `data`) and the attributes of a <bml>. In each
object `type` names the element; texts, numbers and truth values are its attributes; objects and lists under another
key are elements of that name inside. Every object knows its line and column.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from json import JSONDecodeError
from json.decoder import JSONDecoder
from types import MappingProxyType

from kinesic.bml.block import BOUNDS, BmlError, Bounds, Place, refusal
from kinesic.bml.reading.json_words import rewritten
from kinesic.bml.reading.tree import Element

_BLANK = " \t\r\n"
_NAME = re.compile(r"[A-Za-z_][\w.-]*(?::[A-Za-z_][\w.-]*)?")
_NO_TEXT = re.compile(r"[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # what XML cannot say either
_SCOPE: Mapping[str, str] = MappingProxyType({"": ""})
_VALUES = 10  # as many for each element that is allowed
_CONSTRAINTS = ("synchronize", "before", "after")
_BEHAVIOURS = ("behaviours", "behaviors", "data")

Scalar = str | float | bool | None


@dataclass(frozen=True)
class _Object:
    """One object as written."""

    fields: Mapping[str, "_Value"]
    place: Place


_Value = Scalar | _Object | tuple["_Value", ...]


def is_json(text: str) -> bool:
    """Whether a text is meant as JSON."""
    return text.lstrip(f"{_BLANK}\ufeff")[:1] in ("{", "[")


def read_json(text: str, *, source: str, bounds: Bounds = BOUNDS) -> Element:
    """Reads a document as a <bml>.

    Args:
        text: of the document.
        source: its name, for messages.
        bounds: largest size and depth.

    Raises:
        BmlError: too large, too deep, no JSON, or no list of behaviours.
    """
    if len(text) > bounds.size:
        what = f"the document has {len(text)} characters"
        raise refusal(source, Place(1, 1), what, f"at most {bounds.size} are read: split it")
    reader = _Reader(text.removeprefix("\ufeff"), source, bounds)
    value = reader.document()
    if isinstance(value, _Object) and isinstance(inner := value.fields.get("bml"), _Object):
        value = inner
    if isinstance(value, _Object):
        return _block(value, source)
    behaviours = value if isinstance(value, tuple) else ()
    return Element("bml", MappingProxyType({}), tuple(_behaviours(behaviours, source)), Place(1, 1), _SCOPE)


class _Reader:
    """A reader of JSON that knows where objects begin."""

    def __init__(self, text: str, source: str, bounds: Bounds) -> None:
        self._text, self._source, self._bounds = text, source, bounds
        self._decoder, self._count = JSONDecoder(), 0
        self._lines = [0, *(found.end() for found in re.finditer("\n", text))]  # where each begins

    def document(self) -> _Value:
        value, at = self._value(self._skip(0), 0)
        if self._skip(at) < len(self._text):
            raise self._refused(at, "something follows the document", "one object or list is read")
        return value

    def _value(self, at: int, depth: int) -> tuple[_Value, int]:
        if depth > self._bounds.depth:
            raise self._refused(at, f"{depth} levels inside one another", f"at most {self._bounds.depth} are read")
        self._count += 1
        if self._count > _VALUES * self._bounds.elements:
            raise self._refused(at, f"more than {_VALUES * self._bounds.elements} values", "split the document")
        if self._text.startswith("{", at):
            return self._object(at, depth)
        if self._text.startswith("[", at):
            return self._list(at, depth)
        try:
            value, end = self._decoder.raw_decode(self._text, at)
        except ValueError as error:  # of its own kind, or of a number with too many digits
            what = error.msg if isinstance(error, JSONDecodeError) else str(error)
            raise self._refused(at, f"not JSON: {what}", "well-formed JSON is needed") from None
        if isinstance(value, str) and (odd := _NO_TEXT.search(value)):
            raise self._refused(at, f"character {ord(odd[0])} is no character of a text", "leave it out")
        return value, end

    def _object(self, at: int, depth: int) -> tuple[_Object, int]:
        fields: dict[str, _Value] = {}
        place, at = self._place(at), self._skip(at + 1)
        while not self._text.startswith("}", at):
            key, at = self._value(at, depth + 1)
            if not isinstance(key, str):
                raise self._refused(at, f"{key} is no name", 'names are in quotes: "type": "gesture"')
            fields[key], at = self._value(self._skip(self._past(":", at)), depth + 1)
            at = self._next("}", at)
        return _Object(MappingProxyType(fields), place), at + 1

    def _list(self, at: int, depth: int) -> tuple[tuple[_Value, ...], int]:
        items: list[_Value] = []
        at = self._skip(at + 1)
        while not self._text.startswith("]", at):
            item, at = self._value(at, depth + 1)
            items.append(item)
            at = self._next("]", at)
        return tuple(items), at + 1

    def _next(self, close: str, at: int) -> int:
        """Where the next item begins, or the end is."""
        at = self._skip(at)
        return at if self._text.startswith(close, at) else self._skip(self._past(",", at))

    def _past(self, sign: str, at: int) -> int:
        at = self._skip(at)
        if not self._text.startswith(sign, at):
            raise self._refused(at, f"not JSON: '{sign}' is missing", "well-formed JSON is needed")
        return at + 1

    def _skip(self, at: int) -> int:
        while at < len(self._text) and self._text[at] in _BLANK:
            at += 1
        return at

    def _place(self, at: int) -> Place:
        line = bisect_right(self._lines, at)
        return Place(line, at - self._lines[line - 1] + 1)

    def _refused(self, at: int, what: str, remedy: str) -> BmlError:
        return refusal(self._source, self._place(min(at, len(self._text))), what, remedy)


def _block(block: _Object, source: str) -> Element:
    inside: list[Element] = []
    for key, value in block.fields.items():
        if key in _BEHAVIOURS:
            inside += _behaviours(_many(value), source)
        elif key == "required":
            behaviours = [each for each in _many(value) if not _is_constraint(each)]
            inner = (*_behaviours(behaviours, source), *_constraints(value, block.place))
            inside.append(Element("required", MappingProxyType({}), inner, block.place, _SCOPE))
        elif key == "constraints":
            if wrong := [each for each in _many(value) if not _is_constraint(each)]:
                place = wrong[0].place if isinstance(wrong[0], _Object) else block.place
                raise refusal(source, place, "no constraint", f"its type is one of {', '.join(_CONSTRAINTS)}")
            inside += _constraints(value, block.place)
        elif not _is_scalar(value):  # of a type that nobody knows, which is said
            inside += [_inner(key, each, block.place) for each in _many(value)[:1]]
    if block.fields.keys().isdisjoint((*_BEHAVIOURS, "required", "constraints")):
        what = f"the object has no {' or '.join(map(repr, _BEHAVIOURS))}"
        raise refusal(source, block.place, what, 'for example {"id": "b1", "behaviours": [{"type": "head", ...}]}')
    attributes = {key: _text(value) for key, value in block.fields.items() if _is_scalar(value) and key != "type"}
    return Element("bml", MappingProxyType(attributes), tuple(inside), block.place, _SCOPE)


def _is_constraint(value: _Value) -> bool:
    return isinstance(value, _Object) and value.fields.get("type") in _CONSTRAINTS


def _constraints(value: _Value, place: Place) -> Iterator[Element]:
    """The <constraint> of those of some objects that are one."""
    found = tuple(_constraint(each) for each in _many(value) if isinstance(each, _Object) and _is_constraint(each))
    if found:
        yield Element("constraint", MappingProxyType({}), found, place, _SCOPE)


def _behaviours(values: Sequence[_Value], source: str) -> Iterator[Element]:
    for value in values:
        if not isinstance(value, _Object) or not isinstance(kind := value.fields.get("type"), str):
            place = value.place if isinstance(value, _Object) else Place(1, 1)
            raise refusal(source, place, "a behaviour has no type", 'for example "type": "gesture"')
        if _NAME.fullmatch(kind) is None:
            raise refusal(source, value.place, f"the type '{kind}' is no name", 'for example "type": "gesture"')
        fields = {key: each for key, each in value.fields.items() if key != "type"}
        yield rewritten(_element(kind, _Object(MappingProxyType(fields), value.place)))


def _element(name: str, value: _Object) -> Element:
    inside: list[Element | str] = []
    attributes = {}
    for key, each in value.fields.items():
        if key == "text" and isinstance(each, tuple):
            inside.append(Element("text", MappingProxyType({}), tuple(_said(each, value.place)), value.place, _SCOPE))
        elif _is_scalar(each):
            attributes[key] = _text(each)
        else:
            inside += [_inner(key, one, value.place) for one in _many(each)]
    return Element(name, MappingProxyType(attributes), tuple(inside), value.place, _SCOPE)


def _inner(name: str, value: _Value, place: Place) -> Element:
    """An element inside another; a bare text is its content."""
    if isinstance(value, _Object):
        return _element(name, value)
    return Element(name, MappingProxyType({}), (_text(value),), place, _SCOPE)


def _said(pieces: tuple[_Value, ...], place: Place) -> Iterator[Element | str]:
    """Text with marks: `["now ", {"sync": "s1"}, "here"]`."""
    for piece in pieces:
        if isinstance(piece, _Object):
            yield Element("sync", MappingProxyType({"id": _text(piece.fields.get("sync"))}), (), piece.place, _SCOPE)
        else:
            yield _text(piece)


def _constraint(value: _Object) -> Element:
    """`{"type": "after", "ref": "a:end", "refs": ["b:start"]}`."""
    refs = [
        Element("sync", MappingProxyType({"ref": _text(ref)}), (), value.place, _SCOPE)
        for ref in _many(value.fields.get("refs", ()))
    ]
    attributes = {key: _text(value.fields[key]) for key in ("ref",) if key in value.fields}
    return Element(_text(value.fields.get("type")), MappingProxyType(attributes), tuple(refs), value.place, _SCOPE)


def _many(value: _Value) -> tuple[_Value, ...]:
    return value if isinstance(value, tuple) else (value,)


def _is_scalar(value: _Value) -> bool:
    return not isinstance(value, _Object | tuple)


def _text(value: _Value) -> str:
    """A scalar as an attribute is written."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value)
    return "" if value is None else str(value)
