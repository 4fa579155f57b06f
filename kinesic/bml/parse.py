"""BML text to a Block: BML 1.0, the mindmakers draft, Greta's dialect, SmartBody's fragments, and BML as JSON."""

import itertools
from collections.abc import Collection, Iterator
from typing import Literal

from kinesic.bml.agents import keep_own_part
from kinesic.bml.block import BOUNDS, Action, Behaviour, Block, Bounds, Custom, Dialect, NoticeType, Speech
from kinesic.bml.composition import command_of, composition_of, is_command
from kinesic.bml.reading.dialect_words import in_own_words
from kinesic.bml.reading.document import read_document
from kinesic.bml.reading.elements import ACTIONS, richest
from kinesic.bml.reading.manner import manners_of, read_manner, reason_of
from kinesic.bml.reading.namespaces import core_attributes, is_core, namespace
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.references import Constraint, Names, ReferenceReader, check_references
from kinesic.bml.reading.script import pause_of
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.unread import STRAY, note_unread
from kinesic.bml.reading.vocabulary import AGENTS

UNNAMED = "block"  # id of a block that has none
MOST_BEHAVIOURS = 1000  # in one block

_NO_BEHAVIOURS = STRAY | {"constraint"}


def parse(
    text: str | bytes,
    *,
    source: str = "<text>",
    dialect: Dialect | Literal["auto"] = "auto",
    strict: bool = False,
    known_blocks: Collection[str] = (),
    bounds: Bounds = BOUNDS,
    performer: str | None = None,
) -> Block:
    """Reads one <bml>.

    Args:
        text: the document; bytes are decoded as their XML declaration says.
        source: its name, for messages.
        dialect: `auto` takes it from root and namespace.
        strict: refuse behaviours of unknown types, which are `Custom` otherwise.
        known_blocks: ids of other blocks: they may have hyphens in references, and a block without an id gets another.
        bounds: largest size and depth.
        performer: which of several characters this robot is; None: the one that the block is for.

    Raises:
        BmlError: the document is refused: broken XML, a number out of range, or a reference to a behaviour that exists
            nowhere.
    """
    document = read_document(text, source=source, bounds=bounds)
    bml, home = document.bml, namespace(document.bml)
    found = document.dialect if dialect == "auto" else dialect
    written = bml.attributes.get("id", "").strip()
    about = BehaviourElement(written or _unused_id(known_blocks), bml, core_attributes(bml, home=home))
    reading = DocumentReading(source, about.id, found, home)
    needs_id = found == "bml-1.0" or dialect == "draft"  # Greta's blocks have the draft's namespace, but seldom an id
    if needs_id and not written:
        reading.note(NoticeType.PARSING_FAILURE, f"<bml> has no id: it is called '{about.id}'")
    named = _named(bml, reading)
    if document.in_capitals:
        tags = ", ".join(f"<{name}>" for name in document.in_capitals)
        reading.note(NoticeType.PARSING_FAILURE, f"{tags} in capitals: read as if written small")
    note_unread(document.root, bml, [behaviour for behaviour, _ in named], reading)
    if strict:
        _refuse_unknown(named, reading)
    character = about.word(*AGENTS) or None
    bare = [_bare(name, required, reading) for name, required in named]
    bare = keep_own_part(bare, character, performer, reading)
    names = _names(about.id, bare, known_blocks)
    references = ReferenceReader(reading, names)
    cued = [references.add_sync_references(behaviour, name) for behaviour, (name, _) in zip(bare, named, strict=True)]
    behaviours = tuple(behaviour for behaviour, _ in cued)
    manners = manners_of(bml, reading)
    composition, succession = composition_of(about, document.root, reading)
    constraints = (*(order for _, orders in cued for order in orders), *_constraints(bml, references))
    check_references(behaviours, constraints, reading)
    return Block(
        id=about.id,
        behaviours=behaviours,
        constraints=constraints,
        composition=composition,
        character=character,
        dialect=found,
        notices=tuple(reading.notices),
        source=source,
        text=document.text,
        manners=manners,
        succession=succession,
        pause=pause_of(bml, reading),
    )


def _unused_id(known_blocks: Collection[str]) -> str:
    """`UNNAMED`, with a number from 2 where another block is called so."""
    numbered = (f"{UNNAMED}.{count}" for count in itertools.count(2))
    return next(id for id in itertools.chain((UNNAMED,), numbered) if id not in known_blocks)


def _elements(bml: Element, home: str | None, *, required: bool = False) -> Iterator[tuple[Element, bool]]:
    """Behaviours in document order, with whether they are required; Greta nests some in a speech."""
    for child in bml.children:
        is_known = is_core(child, home=home)
        if is_known and child.local == "required":
            yield from _elements(child, home, required=True)
        elif not is_known or child.local not in _NO_BEHAVIOURS:
            yield in_own_words(richest(child, home=home)), required
        if is_known and child.local == "speech":
            inner = (part for part in child.children if part.local in ACTIONS and is_core(part, home=home))
            yield from ((in_own_words(part), required) for part in inner)


def _named(bml: Element, reading: DocumentReading) -> list[tuple[BehaviourElement, bool]]:
    elements = list(_elements(bml, reading.home))
    if len(elements) > MOST_BEHAVIOURS:
        place = elements[MOST_BEHAVIOURS][0].place
        raise reading.refuse(place, f"{len(elements)} behaviours", f"at most {MOST_BEHAVIOURS} are read: split it")
    taken = {element.attributes.get("id", "").strip() for element, _ in elements}
    seen: set[str] = set()
    named = []
    for element, required in elements:
        written = element.attributes.get("id", "").strip()
        if not written and reading.dialect == "bml-1.0":
            reading.note(NoticeType.PARSING_FAILURE, f"<{element.name}> in line {element.place.line} has no id")
        stem = written or element.written.rpartition(":")[2]
        own = written if written and written not in seen else _free(stem, taken)
        if written and own != written:
            what = f"the id '{written}' is used again in line {element.place.line}: that one is called '{own}'"
            reading.note(NoticeType.PARSING_FAILURE, what, behaviour=own)
        seen.add(own)
        taken.add(own)
        named.append((BehaviourElement(own, element, core_attributes(element, home=reading.home)), required))
    return named


def _free(stem: str, taken: set[str]) -> str:
    count = 2 if stem in taken else 1
    while f"{stem}.{count}" in taken:
        count += 1
    return f"{stem}.{count}"


def _bare(named: BehaviourElement, required: bool, reading: DocumentReading) -> Behaviour:
    """A behaviour without its times."""
    element = named.element
    known = is_core(element, home=reading.home) and element.local in ACTIONS
    command = None if known else command_of(named, reading)
    action: Action = ACTIONS[element.local](named, reading) if known else command or Custom(element.name)
    manner = read_manner(named, action, reading)
    agent = named.word(*AGENTS) or None
    return Behaviour(
        named.id,
        element.written,
        action,
        element.place,
        manner=manner,
        required=required,
        agent=agent,
        reason=reason_of(element),
    )


def _names(block: str, behaviours: list[Behaviour], known_blocks: Collection[str]) -> Names:
    speeches = {
        behaviour.id: frozenset(mark.name for mark in behaviour.action.script.marks)
        for behaviour in behaviours
        if isinstance(behaviour.action, Speech)
    }
    marks = {mark: id for id, own in reversed(speeches.items()) for mark in own}
    ids = frozenset(behaviour.id for behaviour in behaviours)
    return Names(block, ids, marks, frozenset(known_blocks) - {block}, speeches)


def _constraints(bml: Element, references: ReferenceReader, *, required: bool = False) -> Iterator[Constraint]:
    for child in bml.children:
        if is_core(child, home=references.reading.home):
            if child.local == "required":
                yield from _constraints(child, references, required=True)
            elif child.local == "constraint":
                yield from references.constraints(child, required=required)


def _refuse_unknown(named: list[tuple[BehaviourElement, bool]], reading: DocumentReading) -> None:
    for name, _ in named:
        is_known = is_core(name.element, home=reading.home) and name.element.local in ACTIONS
        if not is_known and not is_command(name.element):
            what = f"<{name.element.name}> is no behaviour that is known"
            raise reading.refuse(name.element.place, what, f"known are {', '.join(sorted(ACTIONS))}")
