"""Order of blocks, commands to other blocks, and block states.

Source of values and states: BML 1.0, sections 2.6 and 2.7. Attributes and behaviours of extensions are those of ASAP
and of its predecessor Elckerlyc; behaviour names are case-insensitive.
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
from kinesic.bml.reading.namespaces import is_composition_name, select_composition_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.tree import Element

Until = Literal["relax", "end"]  # point that another block must have reached

# Value of the attribute `composition`, in lower case -> composition.
_COMPOSITIONS_BY_NAME = {
    "": Composition.MERGE,
    "merge": Composition.MERGE,
    "blend": Composition.MERGE,  # Greta's default
    "append": Composition.APPEND,
    "append-after": Composition.APPEND,
    "chunk-after": Composition.APPEND,
    "replace": Composition.REPLACE,
}
_COMPOSITION_PATTERN = re.compile(r"([\w-]*+)(?:\s*\((.*)\))?", re.DOTALL)  # name and ids, as in `append-after(a, b)`
_ID_SEPARATOR = re.compile(r"[\s,]+")  # separator of block ids in an attribute
_COMMAND_ELEMENTS = ("interrupt", "activate", "parametervaluechange")  # elements that control other blocks
_VALUE_ATTRIBUTES = ("targetValue", "finalValue", "value")  # attributes with the new value of a <parametervaluechange>


class BlockState(Enum):
    """State in the life cycle of a block."""

    IN_PREP = "IN_PREP"  # planning in progress
    PENDING = "PENDING"  # planned, waiting for its activation
    LURKING = "LURKING"  # waiting for other blocks
    IN_EXEC = "IN_EXEC"
    SUBSIDING = "SUBSIDING"  # all behaviours are retracting
    DONE = "DONE"
    REVOKED = "REVOKED"  # withdrawn before its start
    INTERRUPTED = "INTERRUPTED"
    FAILED = "FAILED"

    @property
    def is_playing(self) -> bool:
        """Whether the block has started and not ended."""
        return self in (BlockState.IN_EXEC, BlockState.SUBSIDING)


def read_composition(node: BehaviourElement, root: Element, reading: DocumentReading) -> tuple[Composition, BlockOrder]:
    """Read the composition of a block and its order among other blocks.

    Args:
        node: the <bml>.
        root: root element of the document; its composition is used if the <bml> has none.
        reading: receives a notice about unknown values.
    """
    text = node.attribute("composition") or root.attributes.get("composition", "").strip()
    match = _COMPOSITION_PATTERN.fullmatch(text.strip())
    name, inside = (match[1].lower(), match[2]) if match else (text, None)
    composition = _COMPOSITIONS_BY_NAME.get(name)
    takes_ids = name in ("append-after", "chunk-after")
    if composition is None or (inside is not None and not takes_ids):
        assumed = (composition or Composition.MERGE).value
        reading.add_notice(
            NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, f"composition '{text}' is unknown and treated as {assumed}"
        )
    extensions = {key.lower(): value for key, value in select_composition_attributes(node.element).items()}
    ids = _split_ids(inside) if takes_ids else ()
    return composition or Composition.MERGE, BlockOrder(
        after=(*(ids if name == "append-after" else ()), *_split_ids(extensions.get("appendafter"))),
        chunk_after=(*(ids if name == "chunk-after" else ()), *_split_ids(extensions.get("chunkafter"))),
        before=_split_ids(extensions.get("prependbefore")),
        chunk_before=_split_ids(extensions.get("chunkbefore")),
        preplanned=extensions.get("preplan", "").strip().lower() in ("true", "1", "yes"),
        interrupts=_split_ids(extensions.get("interrupt")),
        activates=_split_ids(extensions.get("onstart")),
    )


def find_prerequisites(block: Block, present: Mapping[str, BlockState]) -> dict[str, Until]:
    """Return the points that other blocks must reach before a block starts.

    APPEND without ids waits for all blocks sent before, except those that wait for their activation.

    Args:
        block: block that is to start.
        present: state by id of all blocks that have not ended, in the order in which they were sent.
    """
    order, waits = block.order, dict[str, Until]()
    if block.composition is Composition.APPEND and not (order.after or order.chunk_after):
        waits |= {id: "end" for id, state in present.items() if state is not BlockState.PENDING}
    waits |= dict.fromkeys(order.chunk_after, "relax")
    waits |= dict.fromkeys(order.after, "end")
    return {id: until for id, until in waits.items() if id in present and id != block.id}


def find_waiting_blocks(block: Block, present: Mapping[str, BlockState]) -> dict[str, Until]:
    """Return the blocks not yet started that must wait for this block.

    The values are the points of this block for which they wait.
    """
    order = block.order
    waits: dict[str, Until] = {
        **dict.fromkeys(order.chunk_before, "relax"),
        **dict.fromkeys(order.before, "end"),
    }
    waiting = (BlockState.IN_PREP, BlockState.PENDING, BlockState.LURKING)
    return {id: until for id, until in waits.items() if present.get(id) in waiting and id != block.id}


def is_waiting_for_itself(waits: Mapping[str, Mapping[str, Until]], start: str) -> bool:
    """Return whether a block waits for itself, directly or through other blocks."""
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


def read_command(ids: BehaviourElement, reading: DocumentReading) -> BlockCommand | None:
    """Return an element's command to another block, or None.

    Raises:
        BmlError: the command has no target.
    """
    if not is_command(ids.element):
        return None
    target = ids.attribute("target")
    if not target:
        problem = f"<{ids.element.name}> has no target"
        raise reading.error(ids.element.place, problem, "the id of a block is expected, such as target='bml1'")
    match ids.element.local.lower():
        case "interrupt":
            return Interrupt(target, _split_ids(ids.attribute("include")), _split_ids(ids.attribute("exclude")))
        case "activate":
            return Activate(target)
    inside = [ids] + [BehaviourElement(ids.id, child, child.attributes) for child in ids.element.children]
    value = next((word for part in inside if (word := part.attribute(*_VALUE_ATTRIBUTES))), "")
    return ParameterChange(target, ids.attribute("paramId", "parameter", "name"), value)


def is_command(element: Element) -> bool:
    """Return whether an element is a command to another block."""
    return element.local.lower() in _COMMAND_ELEMENTS and is_composition_name(element.name, element)


def _split_ids(text: str | None) -> tuple[str, ...]:
    """Split a list of ids and remove duplicates."""
    return tuple(dict.fromkeys(filter(None, _ID_SEPARATOR.split(text or ""))))
