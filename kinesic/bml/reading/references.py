"""Reading of sync references: `block:behaviour:sync:iteration + offset`.

They stand in sync attributes of behaviours and in constraints. Grammar: OpenBMLParser's `SyncRef` (source: BML 1.0,
2.4). These forms are accepted, too: names with hyphens, a mark without its speech, the block by its own id, and
`after(...)` and `before(...)` in an attribute.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

from kinesic.bml.block import (
    MAX_BLOCK_DURATION,
    Behaviour,
    BmlError,
    NoticeType,
    Place,
    Precedence,
    Synchronize,
    SyncRef,
)
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.sync_names import find_sync_name
from kinesic.bml.reading.tree import Element
from kinesic.bml.timing.points import list_sync_points

Constraint = Synchronize | Precedence
Relation = Literal["at", "after", "before"]

_NUMBER_PATTERN = r"(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?"
_BARE_NUMBER_PATTERN = re.compile(rf"[+-]?{_NUMBER_PATTERN}")  # number without a sync point
_SIGN_PATTERN = re.compile(r"[+-]")  # sign that may start an offset
_OFFSET_PATTERN = re.compile(rf"([+-])\s*({_NUMBER_PATTERN})")
_RELATION_PATTERN = re.compile(r"(after|before)\s*\((.*)\)", re.DOTALL)  # reference with `after` or `before`
_ARRIVAL_SYNCS = ("ready", "attackPeak")  # sync points read as `end` in behaviours that lack them, such as shifts


@dataclass(frozen=True)
class Names:
    """Block, behaviour and mark names that sync references may use."""

    block: str  # id of the block with the reference
    behaviours: frozenset[str] = frozenset()  # ids of the behaviours in this block
    marks: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))  # mark -> first speech with it
    blocks: frozenset[str] = frozenset()  # ids of other blocks
    speeches: Mapping[str, frozenset[str]] = field(default_factory=lambda: MappingProxyType({}))  # marks of each speech
    containing_behaviour: str = ""  # behaviour with the reference; may omit its own id

    def knows(self, name: str) -> bool:
        """Return whether a name is a block, a behaviour or a mark."""
        return name == self.block or name in self.behaviours or name in self.marks or name in self.blocks

    def sync_of(self, owner: str, sync_text: str) -> str:
        """Return the sync point or speech mark that a name denotes.

        An unknown name is returned unchanged.
        """
        is_mark = sync_text in self.speeches.get(owner, ())
        return sync_text if is_mark else find_sync_name(sync_text) or sync_text


def split_relation(text: str) -> tuple[Relation, str]:
    """Split `after(...)` or `before(...)` into relation and reference.

    A plain reference has the relation `at`.
    """
    wrapped = _RELATION_PATTERN.fullmatch(text.strip())
    if wrapped is None:
        return "at", text
    return ("after" if wrapped[1] == "after" else "before"), wrapped[2]


def parse_ref(text: str, names: Names) -> SyncRef:
    """Parse one sync reference.

    Args:
        text: text of the reference.
        names: names in the block that contains the reference.

    Raises:
        BmlError: not a reference, or a time that is not finite or beyond `MAX_BLOCK_DURATION` (without the place).
    """
    trimmed = text.strip()
    if _BARE_NUMBER_PATTERN.fullmatch(trimmed):
        return SyncRef(names.block, "bml", "start", offset=_read_seconds(trimmed))
    as_name = _split_path(trimmed)
    if all(_is_plain(part) or names.knows(part) for part in as_name):
        return _resolve(trimmed, as_name, 0.0, names)
    split = _split_offset(trimmed)
    if split is None:
        return _resolve(trimmed, as_name, 0.0, names)
    path = _split_path(split[0])
    if not all(_is_plain(part) or names.knows(part) for part in path):
        raise _make_error(text)
    return _resolve(trimmed, path, _read_seconds(split[1]), names)


def write_reference(ref: SyncRef, *, relative_to: str | None = None) -> str:
    """Return a sync reference as text, without the block id `relative_to`."""
    if relative_to == ref.block and (ref.behaviour, ref.sync) == ("bml", "start"):
        return repr(ref.offset)
    path = [ref.behaviour, ref.sync] if relative_to == ref.block else [ref.block, ref.behaviour, ref.sync]
    if ref.iteration is not None:
        path.append(str(ref.iteration))
    return ":".join(path) + (f"{ref.offset:+}" if ref.offset else "")


def _split_offset(text: str) -> tuple[str, str] | None:
    """Split a reference at the first sign followed only by a number.

    Returns:
        The text before the sign, and the number with its sign; None without such a sign.
    """
    for sign in _SIGN_PATTERN.finditer(text):
        if offset := _OFFSET_PATTERN.fullmatch(text, sign.start()):
            return text[: sign.start()], offset[1] + offset[2]
    return None


def _read_seconds(text: str) -> float:
    seconds = float(text)
    if not math.isfinite(seconds) or abs(seconds) > MAX_BLOCK_DURATION:
        raise BmlError(
            f"{text} s is out of range; times lie within {-MAX_BLOCK_DURATION:g} to {MAX_BLOCK_DURATION:g} s "
            "of the block's start"
        )
    return seconds


def _split_path(path: str) -> list[str]:
    return [part.strip() for part in path.split(":")]


def _is_plain(part: str) -> bool:
    return ("-" not in part and "+" not in part) or find_sync_name(part) is not None


def _resolve(text: str, parts: list[str], offset: float, names: Names) -> SyncRef:
    *owners, last = parts
    # a trailing sign stays in the name, as in the reference parser
    name = last if names.knows(last) else last[:1] + last[1:].removesuffix("+").removesuffix("-")
    if not all(parts) or not all(_is_plain(part) or names.knows(part) for part in (*owners, name)):
        raise _make_error(text)
    match parts:
        case [mark] if mark in names.marks:
            return SyncRef(names.block, names.marks[mark], mark, offset=offset)
        case [sync_text] if names.containing_behaviour and (sync := find_sync_name(sync_text)):
            return SyncRef(names.block, names.containing_behaviour, sync, offset=offset)
        case [owner, sync] if owner == names.block and owner not in names.behaviours:
            return SyncRef(names.block, "bml", names.sync_of("bml", sync), offset=offset)
        case [owner, sync]:
            return SyncRef(names.block, owner, names.sync_of(owner, sync), offset=offset)
        case [owner, "stroke", count] if count.isdecimal():
            return SyncRef(names.block, owner, "stroke", _read_iteration(text, count), offset)
        case [block, owner, sync] if not _is_iterated(parts, names):
            return SyncRef(block, owner, names.sync_of(owner if block == names.block else "", sync), offset=offset)
        case [block, owner, "stroke", count] if count.isdecimal():
            return SyncRef(block, owner, "stroke", _read_iteration(text, count), offset)
    raise _make_error(text)


def _is_iterated(parts: list[str], names: Names) -> bool:
    """Return whether an invalid three-part reference means behaviour:sync:iteration.

    Valid ones, with `stroke` and a number, are read before; the caller rejects the others.
    """
    block, sync, last = parts
    is_own = block in names.behaviours and block != names.block and block not in names.blocks
    return last.isdecimal() or (is_own and sync == "stroke")


def _read_iteration(text: str, count: str) -> int:
    if int(count) < 1:
        raise _make_error(text)
    return int(count)


def _make_error(text: str) -> BmlError:
    return BmlError(
        f"'{text}' is not a sync reference; use seconds such as '1.5', or 'behaviour:sync', 'behaviour:stroke:2', "
        f"'block:behaviour:sync' with an offset such as '+0.3'"
    )


@dataclass(frozen=True)
class ReferenceReader:
    """Reader of sync references that reports errors with line and column."""

    reading: DocumentReading
    names: Names

    def add_sync_references(self, behaviour: Behaviour, node: BehaviourElement) -> tuple[Behaviour, list[Precedence]]:
        """Add an element's sync attributes to its behaviour as references.

        `after(...)` and `before(...)` become precedence constraints.

        Raises:
            BmlError: an attribute is not a reference.
        """
        syncs: dict[str, SyncRef] = {}
        orders: list[Precedence] = []
        points = list_sync_points(behaviour.action, self.reading.dialect)
        for name, text in node.attributes.items():
            sync = find_sync_name(name)
            if sync in _ARRIVAL_SYNCS and sync not in points and "end" not in node.attributes:
                sync = "end"
            if sync is None or sync in syncs or not text.strip():
                continue
            if sync not in points:
                problem = f"{name} is not a sync point of <{behaviour.type}> and is ignored"
                self.reading.add_notice(NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, problem, behaviour=behaviour.id)
                continue
            relation_kind, inner = split_relation(text)
            ref = self._ref(inner, name, behaviour.place, containing_behaviour=behaviour.id)
            own_ref = SyncRef(self.names.block, behaviour.id, sync)
            if relation_kind == "at":
                syncs[sync] = ref
            else:
                earlier, later = (ref, own_ref) if relation_kind == "after" else (own_ref, ref)
                orders.append(Precedence(earlier, (later,), behaviour.place, behaviour.required))
        return replace(behaviour, syncs=syncs), orders

    def constraints(self, constraint: Element, *, required: bool) -> Iterator[Constraint]:
        """Yield the constraints in a <constraint> element.

        Raises:
            BmlError: a reference is missing or invalid.
        """
        for element in constraint.children:
            inner = [self._of(child) for child in element.children if child.local == "sync"]
            match element.local:
                case "synchronize":
                    refs = ([self._of(element)] if "ref" in element.attributes else []) + inner
                    yield Synchronize(tuple(refs), element.place, required)
                case "after" if inner:
                    yield Precedence(self._of(element), tuple(inner), element.place, required)
                case "before":
                    ref = self._of(element)
                    yield from (Precedence(earlier, (ref,), element.place, required) for earlier in inner)

    def _of(self, element: Element) -> SyncRef:
        return self._ref(element.attributes.get("ref", ""), "ref", element.place)

    def _ref(self, text: str, attribute: str, place: Place, *, containing_behaviour: str = "") -> SyncRef:
        try:
            return parse_ref(text, replace(self.names, containing_behaviour=containing_behaviour))
        except BmlError as error:
            problem, _, remedy = str(error).partition("; ")
            raise self.reading.error(place, f"{attribute}: {problem}", remedy) from None


def check_references(
    behaviours: tuple[Behaviour, ...], constraints: tuple[Constraint, ...], reading: DocumentReading
) -> None:
    """Reject references to behaviours that are missing in this block.

    References to other blocks are not checked.

    Raises:
        BmlError: names the missing behaviour and the existing ones.
    """
    ids = {"bml", *(behaviour.id for behaviour in behaviours)}
    used = [(ref, behaviour.place) for behaviour in behaviours for ref in behaviour.syncs.values()]
    for constraint in constraints:
        refs = constraint.refs if isinstance(constraint, Synchronize) else (constraint.earlier, *constraint.later)
        used += [(ref, constraint.place) for ref in refs]
    for ref, place in used:
        if ref.block == reading.block and ref.behaviour not in ids:
            choices = ", ".join(sorted(ids - {"bml"})) or "none"
            raise reading.error(place, f"no behaviour '{ref.behaviour}' in this block", f"it has {choices}")
    used_ids = {ref.behaviour for ref, _ in used if ref.block == reading.block}
    hyphened = sorted(name for name in used_ids if "-" in name)
    if hyphened:
        problem = f"ids with hyphens in references violate BML's grammar but are accepted: {', '.join(hyphened)}"
        reading.add_notice(NoticeType.PARSING_FAILURE, problem)
