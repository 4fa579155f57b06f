"""How a block meets others: what it waits for, whom it stops, begins or changes, and the states of its life.

Values and states: facts, BML 1.0 sections 2.6 and 2.7; attributes and behaviours of extensions are ASAP's and its
predecessor's, the behaviours in any case of their letters.
"""

import re
from collections.abc import Mapping
from enum import Enum
from typing import Literal

from kinesic.bml.block import (
    Activate,
    Block,
    BlockCommand,
    BlockOrder,
    Composition,
    Interrupt,
    NoticeType,
    ParameterChange,
)
from kinesic.bml.reading.namespaces import extension_attributes, is_composing
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.tree import Element

Until = Literal["relax", "end"]  # what must have come of another block

_KINDS = {
    "": Composition.MERGE,
    "merge": Composition.MERGE,
    "blend": Composition.MERGE,  # Greta's default
    "append": Composition.APPEND,
    "append-after": Composition.APPEND,
    "chunk-after": Composition.APPEND,
    "replace": Composition.REPLACE,
}
_WRITTEN = re.compile(r"([\w-]*+)(?:\s*\((.*)\))?", re.DOTALL)
_SEPARATOR = re.compile(r"[\s,]+")
_COMMANDS = ("interrupt", "activate", "parametervaluechange")
_VALUES = ("targetValue", "finalValue", "value")  # of a change, where it ends


class BlockState(Enum):
    """Where a block is in its life."""

    IN_PREP = "IN_PREP"  # it is being planned
    PENDING = "PENDING"  # planned, to be activated
    LURKING = "LURKING"  # waits for others
    IN_EXEC = "IN_EXEC"
    SUBSIDING = "SUBSIDING"  # all its behaviours retract
    DONE = "DONE"
    REVOKED = "REVOKED"  # taken back before it began
    INTERRUPTED = "INTERRUPTED"
    FAILED = "FAILED"

    @property
    def is_playing(self) -> bool:
        """Whether it has begun and is not over."""
        return self in (BlockState.IN_EXEC, BlockState.SUBSIDING)


def composition_of(about: BehaviourElement, root: Element, reading: DocumentReading) -> tuple[Composition, BlockOrder]:
    """Reads how a block asks to meet others.

    Args:
        about: the <bml>.
        root: of the document, which may say it for the <bml> inside.
        reading: gets a notice about what is not understood.
    """
    written = about.word("composition") or root.attributes.get("composition", "").strip()
    matched = _WRITTEN.fullmatch(written.strip())
    name, inside = (matched[1].lower(), matched[2]) if matched else (written, None)
    kind = _KINDS.get(name)
    takes_ids = name in ("append-after", "chunk-after")
    if kind is None or (inside is not None and not takes_ids):
        taken = (kind or Composition.MERGE).value
        reading.note(NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, f"composition '{written}' is taken as {taken}")
    more = {key.lower(): value for key, value in extension_attributes(about.element).items()}
    named = _ids(inside) if takes_ids else ()
    return kind or Composition.MERGE, BlockOrder(
        after=(*(named if name == "append-after" else ()), *_ids(more.get("appendafter"))),
        chunk_after=(*(named if name == "chunk-after" else ()), *_ids(more.get("chunkafter"))),
        before=_ids(more.get("prependbefore")),
        chunk_before=_ids(more.get("chunkbefore")),
        preplanned=more.get("preplan", "").strip().lower() in ("true", "1", "yes"),
        interrupts=_ids(more.get("interrupt")),
        activates=_ids(more.get("onstart")),
    )


def required_before(block: Block, present: Mapping[str, BlockState]) -> dict[str, Until]:
    """Lists what must come of which other blocks before a block begins.

    APPEND without ids waits for all that were sent before, those left aside that nobody has activated.

    Args:
        block: that is to begin.
        present: id -> state of every block that is not over, in the order in which they were sent.
    """
    succession, waits = block.succession, dict[str, Until]()
    if block.composition is Composition.APPEND and not (succession.after or succession.chunk_after):
        waits |= {id: "end" for id, state in present.items() if state is not BlockState.PENDING}
    waits |= dict.fromkeys(succession.chunk_after, "relax")
    waits |= dict.fromkeys(succession.after, "end")
    return {id: until for id, until in waits.items() if id in present and id != block.id}


def waiting_blocks(block: Block, present: Mapping[str, BlockState]) -> dict[str, Until]:
    """Lists blocks that have not begun and, by this block's wish, wait for it."""
    succession = block.succession
    waits: dict[str, Until] = {
        **dict.fromkeys(succession.chunk_before, "relax"),
        **dict.fromkeys(succession.before, "end"),
    }
    waiting = (BlockState.IN_PREP, BlockState.PENDING, BlockState.LURKING)
    return {id: until for id, until in waits.items() if present.get(id) in waiting and id != block.id}


def waits_for_itself(waits: Mapping[str, Mapping[str, Until]], start: str) -> bool:
    """Checks whether a block waits for itself, directly or through other blocks."""
    seen: set[str] = set()
    fringe = list(waits.get(start, ()))
    while fringe:
        name = fringe.pop()
        if name == start:
            return True
        if name not in seen:
            seen.add(name)
            fringe += waits.get(name, ())
    return False


def command_of(named: BehaviourElement, reading: DocumentReading) -> BlockCommand | None:
    """Reads what an element does to other blocks; None when it is no such element.

    Raises:
        BmlError: it does not say to which block.
    """
    if not is_command(named.element):
        return None
    target = named.word("target")
    if not target:
        what = f"<{named.element.name}> has no target"
        raise reading.refuse(named.element.place, what, "the id of a block is expected, such as target='bml1'")
    match named.element.local.lower():
        case "interrupt":
            return Interrupt(target, _ids(named.word("include")), _ids(named.word("exclude")))
        case "activate":
            return Activate(target)
    inside = [named] + [BehaviourElement(named.id, child, child.attributes) for child in named.element.children]
    value = next((word for part in inside if (word := part.word(*_VALUES))), "")
    return ParameterChange(target, named.word("paramId", "parameter", "name"), value)


def is_command(element: Element) -> bool:
    """Whether an element does something to other blocks."""
    return element.local.lower() in _COMMANDS and is_composing(element.name, element)


def _ids(text: str | None) -> tuple[str, ...]:
    """Splits a list of ids; one that stands twice is kept once."""
    return tuple(dict.fromkeys(filter(None, _SEPARATOR.split(text or ""))))
