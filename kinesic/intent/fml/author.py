"""Generation of BML for an FML-APML document."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from kinesic.bml.block import DEFAULT_BOUNDS, Block, DocumentBounds, Notice, NoticeType, Place
from kinesic.bml.parse import parse_document
from kinesic.bml.reading.document import Document, read_document
from kinesic.bml.reading.namespaces import KINESIC_NAMESPACE
from kinesic.bml.reading.tree import Element, read_tree
from kinesic.bml.reading.wrapping import find_root
from kinesic.intent.behaviour_sets import BehaviourSets, builtin_sets
from kinesic.intent.behaviours import ChosenBehaviour, Selection
from kinesic.intent.budget import STROKE_SPACINGS, MovementBudget
from kinesic.intent.choosing import choose_behaviours
from kinesic.intent.fml.intentions import SPEECH_INTENTIONS, Unreadable, describe_intention, read_intentions
from kinesic.intent.fml.mark_times import estimate_mark_times
from kinesic.intent.fml.names import explain_unknown
from kinesic.intent.greta.agent import Agent
from kinesic.intent.intents import Intent
from kinesic.intent.markup import escape, quote
from kinesic.intent.pacing.memory import Revision
from kinesic.intent.writing import write_behaviours

ROOT_NAME = "fml-apml"  # root element of FML-APML documents


def is_fml(text: str | bytes) -> bool:
    """Return whether a text contains an FML-APML document."""
    return find_root(text) == ROOT_NAME


@dataclass(frozen=True, eq=False)
class _Authored:
    """FML document with the behaviours that show its intentions."""

    document: Document
    behaviours: tuple[ChosenBehaviour, ...]
    lines: tuple[str, ...]  # chosen behaviours as BML elements
    places: Mapping[str, Place]  # places of the intentions in the document, by reason
    warnings: tuple[str, ...]  # unknown intentions, and those without a behaviour, with the reason


def author_fml(
    text: str | bytes,
    *,
    source: str = "<text>",
    sets: BehaviourSets | None = None,
    agent: Agent | None = None,
    seed: int = 0,
    revise: Revision | None = None,
) -> tuple[str, tuple[str, ...]]:
    """Write BML for an FML-APML document.

    It contains the document's own <bml>, and behaviours that show its intentions. The same document, sets and seed give
    the same BML. A document without a <bml> has intentions alone.

    Args:
        text: the document.
        source: its name, for messages.
        sets: behaviours by intention; None: those that come with kinesic.
        agent: with expressivity and preferences; None: neutral.
        seed: of the random choice among alternatives.
        revise: replaces gestures of the chosen behaviours; None: they stay.

    Returns:
        The BML, and a warning for each intention that is unknown or has no behaviour.

    Raises:
        BmlError: the document is refused.
    """
    authored = _author(read_document(text, source=source), sets, agent, seed, revise)
    bml = authored.document.bml
    inside = "".join(f"  {line}\n" for line in authored.lines)
    start = _tag(bml.name, _start_attributes(authored.document.root, bml))
    return f"{start}>{_write_content(bml.content).rstrip()}\n{inside}</{bml.name}>\n", authored.warnings


def parse_fml(
    text: str | bytes,
    *,
    source: str = "<text>",
    performer: str | None = None,
    sets: BehaviourSets | None = None,
    agent: Agent | None = None,
    seed: int = 0,
    known_blocks: Collection[str] = (),
    bounds: DocumentBounds = DEFAULT_BOUNDS,
    revise: Revision | None = None,
) -> Block:
    """Read an FML-APML document with behaviours for its intentions.

    Its notices list intentions that are unknown or have no behaviour, with the reason. Places are those in the
    document; a generated behaviour has the place of its intention.

    Raises:
        BmlError: the document is refused.
    """
    authored = _author(read_document(text, source=source, bounds=bounds), sets, agent, seed, revise)
    document = replace(authored.document, root=(bml := _merge(authored)), bml=bml, dialect="fml-apml")
    block = parse_document(document, source=source, dialect="fml-apml", performer=performer, known_blocks=known_blocks)
    added = tuple(Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, block.id, warning) for warning in authored.warnings)
    return replace(block, notices=(*block.notices, *added))


def _author(
    document: Document, sets: BehaviourSets | None, agent: Agent | None, seed: int, revise: Revision | None
) -> _Authored:
    """Choose the behaviours that show the intentions of a document."""
    bml, marks = document.bml, estimate_mark_times(document.bml)
    roots = [child for child in document.root.children if child.local == "fml"]
    speeches = [child for child in bml.children if child.local == "speech"]
    read = list(read_intentions(roots, speeches, marks))
    intents = [intention for intention in read if isinstance(intention, Intent)]
    sets = sets or builtin_sets()
    selection = choose_behaviours(
        intents, sets, MovementBudget(len(intents), STROKE_SPACINGS, {}), seed=seed, agent=agent
    )
    unreadable = (f"{each.name}, {each.reason}: {each.why}" for each in read if isinstance(each, Unreadable))
    warnings = (
        *_unknown(intents, sets),
        *(f"not shown: {problem}" for problem in (*unreadable, *_unshown(intents, selection, sets))),
    )
    taken = frozenset(element.attributes.get("id", "") for element in _all(bml))
    behaviours = selection.behaviours if revise is None else revise(selection.behaviours, ())
    lines = tuple(write_behaviours(behaviours, taken))
    places = {describe_intention(element): element.place for element in _all(document.root)}
    return _Authored(document, tuple(selection.behaviours), lines, places, warnings)


def _merge(authored: _Authored) -> Element:
    """Return the <bml> of a document with the generated behaviours."""
    bml = authored.document.bml
    attributes = _start_attributes(authored.document.root, bml)
    snippet = "".join(authored.lines)
    generated = read_tree(f"<bml>{snippet}</bml>", source="<generated>").children
    scope = MappingProxyType({**bml.scope, "kinesic": KINESIC_NAMESPACE})
    prefix = bml.name.rpartition(":")[0]
    placed = tuple(
        replace(
            element,
            name=f"{prefix}:{element.name}" if prefix else element.name,
            place=authored.places.get(behaviour.intent.reason, bml.place),
            scope=scope,
        )
        for element, behaviour in zip(generated, authored.behaviours, strict=True)
    )
    content = (*_without_intentions(bml.content), *placed)
    return replace(bml, attributes=MappingProxyType(attributes), content=content, scope=scope)


def _without_intentions(content: Sequence[Element | str]) -> Iterator[Element | str]:
    """Yield BML content without FML's accents and boundaries."""
    for piece in content:
        if isinstance(piece, str):
            yield piece
        elif piece.local not in SPEECH_INTENTIONS:
            yield replace(piece, content=tuple(_without_intentions(piece.content)))


def _unknown(intents: Sequence[Intent], sets: BehaviourSets) -> Iterator[str]:
    """Warn of intentions of unknown type, which show a general intention."""
    for intent in intents:
        if sets.find(intent.name) is not None and (why := explain_unknown(intent.name, sets)):
            yield f"taken as any {intent.name.partition('-')[0]}: {intent.name}, {intent.reason}: {why}"


def _unshown(intents: Sequence[Intent], selection: Selection, sets: BehaviourSets) -> Iterator[str]:
    """Yield each intention without a behaviour, with the reasons."""
    shown = {behaviour.intent.reason for behaviour in selection.behaviours}
    whys: dict[str, dict[str, None]] = {}
    for omission in selection.omissions:
        whys.setdefault(omission.intent.reason, {})[omission.why] = None
    for intent in intents:
        if intent.reason not in shown:
            reasons = "; ".join(whys.get(intent.reason, {})) or "its choice is to show nothing"
            unknown = explain_unknown(intent.name, sets) if sets.find(intent.name) is None else ""
            yield f"{intent.name}, {intent.reason}: {unknown or reasons}"


def _all(element: Element) -> Iterator[Element]:
    yield element
    for child in element.children:
        yield from _all(child)


def _start_attributes(root: Element, bml: Element) -> dict[str, str]:
    """Return the attributes of the generated <bml>, by name.

    They are its own, and the namespaces and `composition` of the FML root, unless the <bml> has its own.
    """
    composed = {
        name: text for name, text in root.attributes.items() if name.startswith("xmlns") or name == "composition"
    }
    return composed | dict(bml.attributes) | {"xmlns:kinesic": KINESIC_NAMESPACE}


def _write_content(content: Sequence[Element | str]) -> str:
    """Write the BML content as XML, without FML accents and boundaries."""
    pieces = []
    for piece in _without_intentions(content):
        if isinstance(piece, str):
            pieces.append(escape(piece))
        else:
            inside = _write_content(piece.content)
            tag = _tag(piece.tag, piece.attributes)
            pieces.append(f"{tag}>{inside}</{piece.tag}>" if inside else f"{tag}/>")
    return "".join(pieces)


def _tag(name: str, attributes: Mapping[str, str]) -> str:
    return " ".join([f"<{name}", *(f"{key}={quote(value)}" for key, value in attributes.items())])
