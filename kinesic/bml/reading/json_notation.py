"""Reading of BML as JSON, including the vocabulary of web realizers.

A document is a list of behaviours, or an object with `behaviours` (or `data`) and the attributes of a <bml>. In each
object `type` is the element name; strings, numbers and booleans are its attributes; objects and lists under another
key are nested elements of that name. Every object stores its line and column.
"""

import json
import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from json import JSONDecodeError
from json.decoder import JSONDecoder
from types import MappingProxyType

from kinesic.bml.block import DEFAULT_BOUNDS, BmlError, DocumentBounds, Place, document_error
from kinesic.bml.reading.json_words import rewrite_json_behaviour
from kinesic.bml.reading.tree import Element

_BLANK_CHARACTERS = " \t\r\n"
_NAME_PATTERN = re.compile(r"[A-Za-z_][\w.-]*(?::[A-Za-z_][\w.-]*)?")  # valid XML name
_INVALID_CHARACTER_PATTERN = re.compile(
    r"[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"
)  # characters invalid in XML
_EMPTY_SCOPE: Mapping[str, str] = MappingProxyType({"": ""})  # prefix -> namespace; JSON documents declare none
_VALUES_PER_ELEMENT = 10  # largest number of JSON values / largest number of elements
_CONSTRAINT_TYPES = ("synchronize", "before", "after")  # values of "type" in a constraint object
_BEHAVIOUR_KEYS = ("behaviours", "behaviors", "data")  # keys of the list of behaviours in a JSON document
_FAULT_REMEDIES = (  # first characters of a faulty JSON value -> remedy
    *((sign, 'put names and texts in double quotes: "type": "gesture"') for sign in "'\u2018\u2019\u201c\u201d"),
    *((sign, "remove the comment") for sign in ("//", "/*", "#")),
    *((word, f"write {word.lower()}") for word in ("True", "False")),
    ("None", "write null"),
    ("...", "write the value itself"),
)
_SHORTHAND_ATTRIBUTES = {  # behaviour name -> attribute meant by a plain value: {"gesture": "wave"}
    "gesture": "lexeme",
    "head": "lexeme",
    "face": "lexeme",
    "faceLexeme": "lexeme",
    "posture": "lexeme",
    "pointing": "target",
    "gaze": "target",
    "speech": "text",
}

Scalar = str | float | bool | None


@dataclass(frozen=True)
class _Object:
    """JSON object with its place in the text."""

    fields: Mapping[str, "_Value"]
    place: Place


_Value = Scalar | _Object | tuple["_Value", ...]


def is_json(text: str) -> bool:
    """Return whether a text starts as JSON."""
    return text.lstrip(f"{_BLANK_CHARACTERS}\ufeff")[:1] in ("{", "[")


def read_json(text: str, *, source: str, bounds: DocumentBounds = DEFAULT_BOUNDS) -> tuple[Element, tuple[str, ...]]:
    """Read a JSON document as a <bml>, and list tolerated faults.

    Args:
        text: text of the document.
        source: name of the document, for messages.
        bounds: maximum size and depth.

    Raises:
        BmlError: too large, too deep, invalid JSON, or without a list of behaviours.
    """
    if len(text) > bounds.size:
        problem = f"the document has {len(text)} characters"
        raise document_error(source, Place(1, 1), problem, f"the limit is {bounds.size}: split it")
    reader = _Reader(text.removeprefix("\ufeff"), source, bounds)
    value = reader.document()
    if isinstance(value, _Object) and isinstance(inner := value.fields.get("bml"), _Object):
        value = inner
    if isinstance(value, _Object):
        return _read_block(value, source), tuple(reader.faults)
    inside = tuple(_read_behaviours(value if isinstance(value, tuple) else (), source))
    return Element("bml", MappingProxyType({}), inside, Place(1, 1), _EMPTY_SCOPE), tuple(reader.faults)


class _Reader:
    """JSON reader that records the place of each object."""

    def __init__(self, text: str, source: str, bounds: DocumentBounds) -> None:
        self._text, self._source, self._bounds = text, source, bounds
        self._decoder, self._count = JSONDecoder(), 0
        self._lines = [0, *(constraints.end() for constraints in re.finditer("\n", text))]  # start of each line
        self.faults: list[str] = []  # tolerated faults, for notices

    def document(self) -> _Value:
        value, position = self._value(self._skip(0), 0)
        if self._skip(position) < len(self._text):
            raise self._error(position, "text after the end of the document", "write one object or list")
        return value

    def _value(self, position: int, depth: int) -> tuple[_Value, int]:
        if depth > self._bounds.depth:
            raise self._error(position, f"{depth} nested levels", f"the limit is {self._bounds.depth}")
        self._count += 1
        if self._count > _VALUES_PER_ELEMENT * self._bounds.elements:
            raise self._error(
                position, f"more than {_VALUES_PER_ELEMENT * self._bounds.elements} values", "split the document"
            )
        if self._text.startswith("{", position):
            return self._object(position, depth)
        if self._text.startswith("[", position):
            return self._list(position, depth)
        try:
            value, end = self._decoder.raw_decode(self._text, position)
        except ValueError as error:  # JSONDecodeError, or a number with too many digits
            problem = error.msg if isinstance(error, JSONDecodeError) else str(error)
            fault = next((entry for entry in _FAULT_REMEDIES if self._text.startswith(entry[0], position)), None)
            remedy = fault[1] if fault else "write well-formed JSON"
            raise self._error(position, f"not JSON: {problem}", remedy) from None
        if isinstance(value, str) and (odd := _INVALID_CHARACTER_PATTERN.search(value)):
            raise self._error(position, f"character {ord(odd[0])} is not allowed in a text", "remove it")
        return value, end

    def _object(self, position: int, depth: int) -> tuple[_Object, int]:
        fields: dict[str, _Value] = {}
        place, position = self._place(position), self._skip(position + 1)
        while not self._text.startswith("}", position):
            key, position = self._value(position, depth + 1)
            if not isinstance(key, str):
                raise self._error(position, f"{key} is not a name", 'put names in quotes: "type": "gesture"')
            fields[key], position = self._value(self._skip(self._past(":", position)), depth + 1)
            position = self._find_next("}", position)
        return _Object(MappingProxyType(fields), place), position + 1

    def _list(self, position: int, depth: int) -> tuple[tuple[_Value, ...], int]:
        items: list[_Value] = []
        position = self._skip(position + 1)
        while not self._text.startswith("]", position):
            item, position = self._value(position, depth + 1)
            items.append(item)
            position = self._find_next("]", position)
        return tuple(items), position + 1

    def _find_next(self, close: str, position: int) -> int:
        """Return the text position of the next JSON item or closing bracket."""
        position = self._skip(position)
        if self._text.startswith(close, position):
            return position
        comma, position = position, self._skip(self._past(",", position))
        if self._text.startswith(close, position):
            place = self._place(comma)
            self.faults.append(f"a comma before '{close}' in line {place.line}, column {place.column} is ignored")
        return position

    def _past(self, sign: str, position: int) -> int:
        position = self._skip(position)
        if not self._text.startswith(sign, position):
            raise self._error(position, f"not JSON: '{sign}' is missing", "write well-formed JSON")
        return position + 1

    def _skip(self, position: int) -> int:
        while position < len(self._text) and self._text[position] in _BLANK_CHARACTERS:
            position += 1
        return position

    def _place(self, position: int) -> Place:
        line = bisect_right(self._lines, position)
        return Place(line, position - self._lines[line - 1] + 1)

    def _error(self, position: int, problem: str, remedy: str) -> BmlError:
        return document_error(self._source, self._place(min(position, len(self._text))), problem, remedy)


def _read_block(block: _Object, source: str) -> Element:
    inside: list[Element] = []
    for key, value in block.fields.items():
        if key in _BEHAVIOUR_KEYS:
            inside += _read_behaviours(_as_tuple(value), source)
        elif key == "required":
            behaviours = [item for item in _as_tuple(value) if not _is_constraint(item)]
            inner = (*_read_behaviours(behaviours, source), *_collect_constraints(value, block.place))
            inside.append(Element("required", MappingProxyType({}), inner, block.place, _EMPTY_SCOPE))
        elif key == "constraints":
            if wrong := [item for item in _as_tuple(value) if not _is_constraint(item)]:
                place = wrong[0].place if isinstance(wrong[0], _Object) else block.place
                raise document_error(
                    source, place, "not a constraint", f"its type must be one of {', '.join(_CONSTRAINT_TYPES)}"
                )
            inside += _collect_constraints(value, block.place)
        elif not _is_scalar(value):  # unknown type; a notice follows
            inside += [_read_nested(key, item, block.place) for item in _as_tuple(value)[:1]]
    if block.fields.keys().isdisjoint((*_BEHAVIOUR_KEYS, "required", "constraints")):
        problem = f"the object has no {' or '.join(map(repr, _BEHAVIOUR_KEYS))}"
        raise document_error(source, block.place, problem, _suggest_document(block))
    attributes = {key: _to_text(value) for key, value in block.fields.items() if _is_scalar(value) and key != "type"}
    return Element("bml", MappingProxyType(attributes), tuple(inside), block.place, _EMPTY_SCOPE)


def _suggest_document(block: _Object) -> str:
    """Return an error's remedy, which shows the document in full JSON."""
    behaviour = _suggest_behaviour(block) or '{"type": "head", "lexeme": "NOD"}'
    return f'write {{"id": "b1", "behaviours": [{behaviour}]}}'


def _suggest_behaviour(value: _Object) -> str | None:
    """Expand a shorthand such as {"gesture": "wave"} to JSON, or return None."""
    fields = {key: item for key, item in value.fields.items() if _is_scalar(item)}
    if isinstance(fields.get("type"), str):
        return json.dumps(fields, ensure_ascii=False)
    name = next((key for key in value.fields if key in _SHORTHAND_ATTRIBUTES), None)
    if name is None:
        return None
    inner = value.fields[name]
    if isinstance(inner, _Object):
        fields |= {key: item for key, item in inner.fields.items() if _is_scalar(item)}
    elif isinstance(inner, str):
        fields = {key: item for key, item in fields.items() if key != name} | {_SHORTHAND_ATTRIBUTES[name]: inner}
    return json.dumps({"type": name} | fields, ensure_ascii=False)


def _is_constraint(value: _Value) -> bool:
    return isinstance(value, _Object) and value.fields.get("type") in _CONSTRAINT_TYPES


def _collect_constraints(value: _Value, place: Place) -> Iterator[Element]:
    """Yield one <constraint> element that contains all constraint objects."""
    constraints = tuple(
        _read_constraint(item) for item in _as_tuple(value) if isinstance(item, _Object) and _is_constraint(item)
    )
    if constraints:
        yield Element("constraint", MappingProxyType({}), constraints, place, _EMPTY_SCOPE)


def _read_behaviours(values: Sequence[_Value], source: str) -> Iterator[Element]:
    for value in values:
        if not isinstance(value, _Object) or not isinstance(kind := value.fields.get("type"), str):
            place = value.place if isinstance(value, _Object) else Place(1, 1)
            suggestion = _suggest_behaviour(value) if isinstance(value, _Object) else None
            remedy = f"write {suggestion}" if suggestion else 'for example "type": "gesture"'
            raise document_error(source, place, "a behaviour has no type", remedy)
        if _NAME_PATTERN.fullmatch(kind) is None:
            raise document_error(
                source, value.place, f"the type '{kind}' is not a name", 'for example "type": "gesture"'
            )
        fields = {key: item for key, item in value.fields.items() if key != "type"}
        yield rewrite_json_behaviour(_read_element(kind, _Object(MappingProxyType(fields), value.place)))


def _read_element(name: str, value: _Object) -> Element:
    inside: list[Element | str] = []
    attributes = {}
    for key, item in value.fields.items():
        if key == "text" and isinstance(item, tuple):
            inside.append(
                Element(
                    "text", MappingProxyType({}), tuple(_read_mixed_text(item, value.place)), value.place, _EMPTY_SCOPE
                )
            )
        elif _is_scalar(item):
            attributes[key] = _to_text(item)
        else:
            inside += [_read_nested(key, nested, value.place) for nested in _as_tuple(item)]
    return Element(name, MappingProxyType(attributes), tuple(inside), value.place, _EMPTY_SCOPE)


def _read_nested(name: str, value: _Value, place: Place) -> Element:
    """Read a JSON value as a nested element.

    A plain value becomes its text.
    """
    if isinstance(value, _Object):
        return _read_element(name, value)
    return Element(name, MappingProxyType({}), (_to_text(value),), place, _EMPTY_SCOPE)


def _read_mixed_text(pieces: tuple[_Value, ...], place: Place) -> Iterator[Element | str]:
    """Yield text and marks of a list: `["now ", {"sync": "s1"}, "here"]`."""
    for piece in pieces:
        if isinstance(piece, _Object):
            yield Element(
                "sync", MappingProxyType({"id": _to_text(piece.fields.get("sync"))}), (), piece.place, _EMPTY_SCOPE
            )
        else:
            yield _to_text(piece)


def _read_constraint(value: _Object) -> Element:
    """Read a constraint: `{"type": "after", "ref": "a:end", "refs": ["b:start"]}`."""
    refs = [
        Element("sync", MappingProxyType({"ref": _to_text(ref)}), (), value.place, _EMPTY_SCOPE)
        for ref in _as_tuple(value.fields.get("refs", ()))
    ]
    attributes = {key: _to_text(value.fields[key]) for key in ("ref",) if key in value.fields}
    return Element(
        _to_text(value.fields.get("type")), MappingProxyType(attributes), tuple(refs), value.place, _EMPTY_SCOPE
    )


def _as_tuple(value: _Value) -> tuple[_Value, ...]:
    return value if isinstance(value, tuple) else (value,)


def _is_scalar(value: _Value) -> bool:
    return not isinstance(value, _Object | tuple)


def _to_text(value: _Value) -> str:
    """Convert a JSON scalar to the text of an attribute."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value)
    return "" if value is None else str(value)
