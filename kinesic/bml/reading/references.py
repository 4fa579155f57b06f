"""References: `block:behaviour:sync:iteration + offset`, in sync attributes of behaviours and in constraints.

Grammar: OpenBMLParser's `SyncRef` (facts: BML 1.0, 2.4). Beyond it, what can be resolved is accepted: names with
hyphens, a mark without its speech, the block by its own id, and `after(...)` and `before(...)` in an attribute.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

from kinesic.bml.block import Behaviour, BmlError, NoticeType, Place, Precedence, Synchronize, SyncRef
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.sync_names import sync_name
from kinesic.bml.reading.tree import Element
from kinesic.bml.timing.points import sync_points

Constraint = Synchronize | Precedence
Relation = Literal["at", "after", "before"]

LONGEST_BLOCK = 1200.0  # [s] how long a block may last, and how far a time may lie from its start

_NUMBER = r"(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?"
_BARE = re.compile(rf"[+-]?{_NUMBER}")
_SIGN = re.compile(r"[+-]")
_OFFSET = re.compile(rf"([+-])\s*({_NUMBER})")
_WRAPPED = re.compile(r"(after|before)\s*\((.*)\)", re.DOTALL)
_ARRIVALS = ("ready", "attackPeak")  # of what stays, whose end is when it has come


@dataclass(frozen=True)
class Names:
    """What a reference can be resolved with."""

    block: str  # id of the block it stands in
    behaviours: frozenset[str] = frozenset()  # ids in this block
    marks: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))  # mark -> the first speech with it
    blocks: frozenset[str] = frozenset()  # ids of other blocks that are known
    speeches: Mapping[str, frozenset[str]] = field(default_factory=lambda: MappingProxyType({}))  # id -> its marks
    within: str = ""  # behaviour in whose attribute it stands: it may name its own sync points alone

    def knows(self, name: str) -> bool:
        """Whether a name is one of these."""
        return name == self.block or name in self.behaviours or name in self.marks or name in self.blocks

    def sync_of(self, owner: str, written: str) -> str:
        """Finds the sync point of a behaviour, or the mark of a speech, that is meant by a name."""
        is_mark = written in self.speeches.get(owner, ())
        return written if is_mark else sync_name(written) or written


def relation(text: str) -> tuple[Relation, str]:
    """Takes `after(...)` or `before(...)` off a reference; without them it is `at`."""
    wrapped = _WRAPPED.fullmatch(text.strip())
    if wrapped is None:
        return "at", text
    return ("after" if wrapped[1] == "after" else "before"), wrapped[2]


def parse_ref(text: str, names: Names) -> SyncRef:
    """Reads one sync reference.

    Args:
        text: as written.
        names: of the block it stands in.

    Raises:
        BmlError: not a reference, or a time that is not finite or beyond `LONGEST_BLOCK` (without the place).
    """
    trimmed = text.strip()
    if _BARE.fullmatch(trimmed):
        return SyncRef(names.block, "bml", "start", offset=_seconds(trimmed))
    as_name = _parts(trimmed)
    if all(_is_plain(part) or names.knows(part) for part in as_name):
        return _resolved(trimmed, as_name, 0.0, names)
    split = _split_offset(trimmed)
    if split is None:
        return _resolved(trimmed, as_name, 0.0, names)
    path = _parts(split[0])
    if not all(_is_plain(part) or names.knows(part) for part in path):
        raise _unreadable(text)
    return _resolved(trimmed, path, _seconds(split[1]), names)


def write_reference(ref: SyncRef, *, relative_to: str | None = None) -> str:
    """Writes a reference; inside the block `relative_to`, the block's id is left out."""
    if relative_to == ref.block and (ref.behaviour, ref.sync) == ("bml", "start"):
        return repr(ref.offset)
    path = [ref.behaviour, ref.sync] if relative_to == ref.block else [ref.block, ref.behaviour, ref.sync]
    if ref.iteration is not None:
        path.append(str(ref.iteration))
    return ":".join(path) + (f"{ref.offset:+}" if ref.offset else "")


def _split_offset(text: str) -> tuple[str, str] | None:
    """What goes before the first sign with nothing but a number behind it, and the number with its sign."""
    for sign in _SIGN.finditer(text):
        if offset := _OFFSET.fullmatch(text, sign.start()):
            return text[: sign.start()], offset[1] + offset[2]
    return None


def _seconds(text: str) -> float:
    seconds = float(text)
    if not math.isfinite(seconds) or abs(seconds) > LONGEST_BLOCK:
        raise BmlError(
            f"{text} s is out of range; times lie within {-LONGEST_BLOCK:g} to {LONGEST_BLOCK:g} s of the block's start"
        )
    return seconds


def _parts(path: str) -> list[str]:
    return [part.strip() for part in path.split(":")]


def _is_plain(part: str) -> bool:
    return ("-" not in part and "+" not in part) or sync_name(part) is not None


def _resolved(text: str, parts: list[str], offset: float, names: Names) -> SyncRef:
    *owners, last = parts
    # a sign with nothing behind it stays in the name, as the reference parser has it
    name = last if names.knows(last) else last[:1] + last[1:].removesuffix("+").removesuffix("-")
    if not all(parts) or not all(_is_plain(part) or names.knows(part) for part in (*owners, name)):
        raise _unreadable(text)
    match parts:
        case [mark] if mark in names.marks:
            return SyncRef(names.block, names.marks[mark], mark, offset=offset)
        case [own] if names.within and (sync := sync_name(own)):
            return SyncRef(names.block, names.within, sync, offset=offset)
        case [owner, sync] if owner == names.block and owner not in names.behaviours:
            return SyncRef(names.block, "bml", names.sync_of("bml", sync), offset=offset)
        case [owner, sync]:
            return SyncRef(names.block, owner, names.sync_of(owner, sync), offset=offset)
        case [owner, "stroke", count] if count.isdecimal():
            return SyncRef(names.block, owner, "stroke", _iteration(text, count), offset)
        case [block, owner, sync] if not _is_iterated(parts, names):
            return SyncRef(block, owner, names.sync_of(owner if block == names.block else "", sync), offset=offset)
        case [block, owner, "stroke", count] if count.isdecimal():
            return SyncRef(block, owner, "stroke", _iteration(text, count), offset)
    raise _unreadable(text)


def _is_iterated(parts: list[str], names: Names) -> bool:
    """Whether three parts can only be meant as behaviour, sync and a (here impossible) iteration."""
    block, sync, last = parts
    is_own = block in names.behaviours and block != names.block and block not in names.blocks
    return last.isdecimal() or (is_own and sync == "stroke")


def _iteration(text: str, count: str) -> int:
    if int(count) < 1:
        raise _unreadable(text)
    return int(count)


def _unreadable(text: str) -> BmlError:
    return BmlError(
        f"'{text}' is no sync reference; seconds such as '1.5', or 'behaviour:sync', 'behaviour:stroke:2', "
        f"'block:behaviour:sync' with an offset such as '+0.3' are"
    )


@dataclass(frozen=True)
class ReferenceReader:
    """Reads references and says where they stand when they are wrong."""

    reading: DocumentReading
    names: Names

    def add_sync_references(self, behaviour: Behaviour, named: BehaviourElement) -> tuple[Behaviour, list[Precedence]]:
        """Adds the sync attributes of its element to a behaviour; `after(...)` and `before(...)` become orders.

        Raises:
            BmlError: an attribute is no reference.
        """
        syncs: dict[str, SyncRef] = {}
        orders: list[Precedence] = []
        points = sync_points(behaviour.action, self.reading.dialect)
        for name, text in named.attributes.items():
            sync = sync_name(name)
            if sync in _ARRIVALS and sync not in points and "end" not in named.attributes:
                sync = "end"
            if sync is None or sync in syncs or not text.strip():
                continue
            if sync not in points:
                what = f"{name} is no sync point of <{behaviour.type}> and passed over"
                self.reading.note(NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, what, behaviour=behaviour.id)
                continue
            how, inner = relation(text)
            ref = self._ref(inner, name, behaviour.place, within=behaviour.id)
            own = SyncRef(self.names.block, behaviour.id, sync)
            if how == "at":
                syncs[sync] = ref
            else:
                earlier, later = (ref, own) if how == "after" else (own, ref)
                orders.append(Precedence(earlier, (later,), behaviour.place, behaviour.required))
        return replace(behaviour, syncs=syncs), orders

    def constraints(self, constraint: Element, *, required: bool) -> Iterator[Constraint]:
        """Reads what a <constraint> holds.

        Raises:
            BmlError: a reference is missing or is none.
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

    def _ref(self, text: str, attribute: str, place: Place, *, within: str = "") -> SyncRef:
        try:
            return parse_ref(text, replace(self.names, within=within))
        except BmlError as error:
            what, _, remedy = str(error).partition("; ")
            raise self.reading.refuse(place, f"{attribute}: {what}", remedy) from None


def check_references(
    behaviours: tuple[Behaviour, ...], constraints: tuple[Constraint, ...], reading: DocumentReading
) -> None:
    """Refuses references to behaviours that this block does not have; other blocks are not looked into.

    Raises:
        BmlError: names the behaviour that is missing, and those that exist.
    """
    ids = {"bml", *(behaviour.id for behaviour in behaviours)}
    used = [(ref, behaviour.place) for behaviour in behaviours for ref in behaviour.syncs.values()]
    for constraint in constraints:
        refs = constraint.refs if isinstance(constraint, Synchronize) else (constraint.earlier, *constraint.later)
        used += [(ref, constraint.place) for ref in refs]
    for ref, place in used:
        if ref.block == reading.block and ref.behaviour not in ids:
            known = ", ".join(sorted(ids - {"bml"})) or "none"
            raise reading.refuse(place, f"no behaviour '{ref.behaviour}' in this block", f"it has {known}")
    own = {ref.behaviour for ref, _ in used if ref.block == reading.block}
    hyphened = sorted(name for name in own if "-" in name)
    if hyphened:
        what = f"ids with hyphens in references are outside of BML's grammar, taken as written: {', '.join(hyphened)}"
        reading.note(NoticeType.PARSING_FAILURE, what)
