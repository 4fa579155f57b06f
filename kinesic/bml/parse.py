"""Parsing of BML in all supported dialects into a `Block`.

Dialects: BML 1.0, the mindmakers draft, Greta's dialect, SmartBody fragments, and BML as JSON.
"""

import itertools
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Literal

from kinesic.bml.agents import assign_agents
from kinesic.bml.block import (
    DEFAULT_BLOCK_ID,
    DEFAULT_BOUNDS,
    Action,
    Behaviour,
    Block,
    Custom,
    Dialect,
    DocumentBounds,
    NoticeType,
    Speech,
)
from kinesic.bml.composition import is_command, read_command, read_composition
from kinesic.bml.reading.dialect_words import translate_dialect
from kinesic.bml.reading.document import Document, read_document
from kinesic.bml.reading.elements import ACTION_READERS, select_form
from kinesic.bml.reading.manner import read_block_manners, read_manner, read_reason
from kinesic.bml.reading.namespaces import find_namespace, is_core, select_core_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.references import Constraint, Names, ReferenceReader, check_references
from kinesic.bml.reading.script import read_pause
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.unread import INEFFECTIVE_ELEMENTS, note_unread
from kinesic.bml.reading.vocabulary import AGENT_ATTRIBUTES

_NON_BEHAVIOUR_ELEMENTS = INEFFECTIVE_ELEMENTS | {"constraint"}  # children of a <bml> that are not behaviours


def parse(
    text: str | bytes,
    *,
    source: str = "<text>",
    dialect: Dialect | Literal["auto"] = "auto",
    strict: bool = False,
    known_blocks: Collection[str] = (),
    bounds: DocumentBounds = DEFAULT_BOUNDS,
    performer: str | None = None,
    recordings: Path | None = None,
) -> Block:
    """Parse a document with one <bml> into a `Block`.

    Args:
        text: the document; bytes are decoded as their XML declaration says.
        source: name of the document, for messages.
        dialect: `auto` infers the dialect from root and namespace.
        strict: reject behaviours of unknown types instead of reading them as `Custom`.
        known_blocks: ids of other blocks. References may contain them even with hyphens; a block without an id gets a
            different one.
        bounds: maximum size, depth and number of behaviours.
        performer: character that this robot plays; None: the character that the block addresses.
        recordings: folder of the recordings of a document that is no file; None: they are not played.

    Raises:
        BmlError: broken XML, a number out of range, or a reference to a missing behaviour.
    """
    document = read_document(text, source=source, bounds=bounds)
    return parse_document(
        document,
        source=source,
        dialect=dialect,
        strict=strict,
        known_blocks=known_blocks,
        performer=performer,
        recordings=recordings,
        max_behaviours=bounds.behaviours,
    )


def parse_document(
    document: Document,
    *,
    source: str = "<text>",
    dialect: Dialect | Literal["auto"] = "auto",
    strict: bool = False,
    known_blocks: Collection[str] = (),
    performer: str | None = None,
    max_behaviours: int = DEFAULT_BOUNDS.behaviours,
    recordings: Path | None = None,
) -> Block:
    """Convert a document tree to a `Block`.

    Arguments as in `parse`.

    Raises:
        BmlError: a number out of range, or a reference to a missing behaviour.
    """
    bml, home = document.bml, find_namespace(document.bml)
    document_dialect = document.dialect if dialect == "auto" else dialect
    document_id = bml.attributes.get("id", "").strip()
    block_node = BehaviourElement(
        document_id or _find_unused_id(known_blocks), bml, select_core_attributes(bml, home=home)
    )
    reading = DocumentReading(source, block_node.id, document_dialect, home, recordings)
    needs_id = (
        document_dialect == "bml-1.0" or dialect == "draft"
    )  # Greta's blocks use the draft's namespace without ids
    if needs_id and not document_id:
        reading.add_notice(NoticeType.PARSING_FAILURE, f"<bml> has no id: '{block_node.id}' is used")
    for note in document.notes:
        reading.add_notice(NoticeType.PARSING_FAILURE, note)
    nodes = _read_nodes(bml, reading, max_behaviours)
    if document.in_capitals:
        tags = ", ".join(f"<{name}>" for name in document.in_capitals)
        reading.add_notice(NoticeType.PARSING_FAILURE, f"{tags} in capitals: read as lower case")
    note_unread(document.root, bml, [behaviour for behaviour, _ in nodes], reading)
    if strict:
        _reject_unknown(nodes, reading)
    character = block_node.attribute(*AGENT_ATTRIBUTES) or None
    untimed = [_read_behaviour(node, required, reading) for node, required in nodes]
    untimed = assign_agents(untimed, character, performer, reading)
    names = _collect_names(block_node.id, untimed, known_blocks)
    references = ReferenceReader(reading, names)
    timed = [references.add_sync_references(item, node) for item, (node, _) in zip(untimed, nodes, strict=True)]
    behaviours = tuple(behaviour for behaviour, _ in timed)
    manners = read_block_manners(bml, reading)
    composition, order = read_composition(block_node, document.root, reading)
    constraints = (
        *(precedence for _, precedences in timed for precedence in precedences),
        *_constraints(bml, references),
    )
    check_references(behaviours, constraints, reading)
    return Block(
        id=block_node.id,
        behaviours=behaviours,
        constraints=constraints,
        composition=composition,
        character=character,
        dialect=document_dialect,
        notices=tuple(reading.notices),
        source=source,
        text=document.text,
        manners=manners,
        order=order,
        pause=read_pause(bml, reading),
    )


def _find_unused_id(known_blocks: Collection[str]) -> str:
    """Return `DEFAULT_BLOCK_ID`, numbered from 2 if other blocks use it."""
    numbered = (f"{DEFAULT_BLOCK_ID}.{count}" for count in itertools.count(2))
    return next(id for id in itertools.chain((DEFAULT_BLOCK_ID,), numbered) if id not in known_blocks)


def _find_behaviour_elements(
    bml: Element, home: str | None, *, required: bool = False
) -> Iterator[tuple[Element, bool]]:
    """Yield the behaviour elements in document order, each with its `required` flag.

    In Greta's documents, behaviours may be nested in a speech.
    """
    for child in bml.children:
        is_known = is_core(child, home=home)
        if is_known and child.local == "required":
            yield from _find_behaviour_elements(child, home, required=True)
        elif not is_known or child.local not in _NON_BEHAVIOUR_ELEMENTS:
            yield translate_dialect(select_form(child, home=home)), required
        if is_known and child.local == "speech":
            inner = (part for part in child.children if part.local in ACTION_READERS and is_core(part, home=home))
            yield from ((translate_dialect(part), required) for part in inner)


def _read_nodes(bml: Element, reading: DocumentReading, limit: int) -> list[tuple[BehaviourElement, bool]]:
    elements = list(_find_behaviour_elements(bml, reading.home))
    if len(elements) > limit:
        place = elements[limit][0].place
        raise reading.error(place, f"{len(elements)} behaviours", f"the limit is {limit}: split the block")
    used_ids = {element.attributes.get("id", "").strip() for element, _ in elements}
    seen: set[str] = set()
    nodes = []
    for element, required in elements:
        element_id = element.attributes.get("id", "").strip()
        if not element_id and reading.dialect == "bml-1.0":
            reading.add_notice(NoticeType.PARSING_FAILURE, f"<{element.name}> in line {element.place.line} has no id")
        stem = element_id or element.tag.rpartition(":")[2]
        unique_id = element_id if element_id and element_id not in seen else _find_free_id(stem, used_ids)
        if element_id and unique_id != element_id:
            line = element.place.line
            problem = f"the id '{element_id}' is used again in line {line}: it becomes '{unique_id}' there"
            reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=unique_id)
        seen.add(unique_id)
        used_ids.add(unique_id)
        nodes.append(
            (BehaviourElement(unique_id, element, select_core_attributes(element, home=reading.home)), required)
        )
    return nodes


def _find_free_id(stem: str, used_ids: set[str]) -> str:
    count = 2 if stem in used_ids else 1
    while f"{stem}.{count}" in used_ids:
        count += 1
    return f"{stem}.{count}"


def _read_behaviour(node: BehaviourElement, required: bool, reading: DocumentReading) -> Behaviour:
    """Read a behaviour without its sync references."""
    element = node.element
    is_known = is_core(element, home=reading.home) and element.local in ACTION_READERS
    command = None if is_known else read_command(node, reading)
    action: Action = ACTION_READERS[element.local](node, reading) if is_known else command or Custom(element.name)
    manner = read_manner(node, action, reading)
    agent = node.attribute(*AGENT_ATTRIBUTES) or None
    return Behaviour(
        node.id,
        element.tag,
        action,
        element.place,
        manner=manner,
        required=required,
        agent=agent,
        reason=read_reason(element),
    )


def _collect_names(block: str, behaviours: list[Behaviour], known_blocks: Collection[str]) -> Names:
    speeches = {
        behaviour.id: frozenset(mark.name for mark in behaviour.action.script.marks)
        for behaviour in behaviours
        if isinstance(behaviour.action, Speech)
    }
    marks = {mark: id for id, names in reversed(speeches.items()) for mark in names}
    ids = frozenset(behaviour.id for behaviour in behaviours)
    return Names(block, ids, marks, frozenset(known_blocks) - {block}, speeches)


def _constraints(bml: Element, references: ReferenceReader, *, required: bool = False) -> Iterator[Constraint]:
    for child in bml.children:
        if is_core(child, home=references.reading.home):
            if child.local == "required":
                yield from _constraints(child, references, required=True)
            elif child.local == "constraint":
                yield from references.constraints(child, required=required)


def _reject_unknown(nodes: list[tuple[BehaviourElement, bool]], reading: DocumentReading) -> None:
    for node, _ in nodes:
        is_known = is_core(node.element, home=reading.home) and node.element.local in ACTION_READERS
        if not is_known and not is_command(node.element):
            problem = f"<{node.element.name}> is not a known behaviour"
            raise reading.error(node.element.place, problem, f"known behaviours: {', '.join(sorted(ACTION_READERS))}")
