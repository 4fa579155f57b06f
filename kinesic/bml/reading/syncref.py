"""Sync references: `block:behaviour:sync:iteration + offset`, and the forms that dialects add to it.

Grammar: OpenBMLParser's `SyncRef` (facts: BML 1.0, 2.4). Beyond it, what can be resolved is accepted: names with
hyphens, a mark without its speech, the block by its own id.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from kinesic.bml.block import BmlError, SyncRef

LONGEST = 1200.0  # [s] how long a block may last, and how far a time may lie from its start

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_BARE = re.compile(rf"[+-]?{_NUMBER}")
_OFFSET = re.compile(rf"(?P<path>.*?)\s*(?P<sign>[+-])\s*(?P<number>{_NUMBER})", re.DOTALL)
_WRAPPED = re.compile(r"(after|before)\s*\((.*)\)", re.DOTALL)

Relation = Literal["at", "after", "before"]


@dataclass(frozen=True)
class Names:
    """What a reference can be resolved with."""

    block: str  # id of the block it stands in
    behaviours: frozenset[str] = frozenset()  # ids in this block
    marks: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))  # mark -> the first speech with it
    blocks: frozenset[str] = frozenset()  # ids of other blocks that are known

    def knows(self, name: str) -> bool:
        """Whether a name is one of these."""
        return name == self.block or name in self.behaviours or name in self.marks or name in self.blocks


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
        BmlError: not a reference, or a time that is not finite or beyond `LONGEST` (without the place).
    """
    trimmed = text.strip()
    if _BARE.fullmatch(trimmed):
        return SyncRef(names.block, "bml", "start", offset=_seconds(trimmed))
    as_name = _parts(trimmed)
    if all(_is_plain(part) or names.knows(part) for part in as_name):
        return _resolved(trimmed, as_name, 0.0, names)
    split = _OFFSET.fullmatch(trimmed)
    if split is None:
        return _resolved(trimmed, as_name, 0.0, names)
    path = _parts(split["path"])
    if not all(_is_plain(part) or names.knows(part) for part in path):
        raise _unreadable(text)
    return _resolved(trimmed, path, _seconds(split["sign"] + split["number"]), names)


def write_reference(ref: SyncRef, *, relative_to: str | None = None) -> str:
    """Writes a reference; inside the block `relative_to`, the block's id is left out."""
    if relative_to == ref.block and (ref.behaviour, ref.sync) == ("bml", "start"):
        return repr(ref.offset)
    path = [ref.behaviour, ref.sync] if relative_to == ref.block else [ref.block, ref.behaviour, ref.sync]
    if ref.iteration is not None:
        path.append(str(ref.iteration))
    return ":".join(path) + (f"{ref.offset:+}" if ref.offset else "")


def _seconds(text: str) -> float:
    seconds = float(text)
    if not math.isfinite(seconds) or abs(seconds) > LONGEST:
        raise BmlError(f"{text} s is out of range; times lie within {-LONGEST:g} to {LONGEST:g} s of the block's start")
    return seconds


def _parts(path: str) -> list[str]:
    return [part.strip() for part in path.split(":")]


def _is_plain(part: str) -> bool:
    return "-" not in part and "+" not in part


def _resolved(text: str, parts: list[str], offset: float, names: Names) -> SyncRef:
    *owners, last = parts
    # a sign with nothing behind it stays in the name, as the reference parser has it
    name = last if names.knows(last) else last[:1] + last[1:].removesuffix("+").removesuffix("-")
    if not all(parts) or not all(_is_plain(part) or names.knows(part) for part in (*owners, name)):
        raise _unreadable(text)
    match parts:
        case [mark] if mark in names.marks:
            return SyncRef(names.block, names.marks[mark], mark, offset=offset)
        case [owner, sync] if owner == names.block and owner not in names.behaviours:
            return SyncRef(names.block, "bml", sync, offset=offset)
        case [owner, sync]:
            return SyncRef(names.block, owner, sync, offset=offset)
        case [owner, "stroke", count] if count.isdecimal():
            return SyncRef(names.block, owner, "stroke", _iteration(text, count), offset)
        case [block, owner, sync] if not _is_iterated(parts, names):
            return SyncRef(block, owner, sync, offset=offset)
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
