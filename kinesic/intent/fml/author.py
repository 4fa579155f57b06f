"""Writes BML for an FML-APML document: its own <bml>, and behaviours that show its intentions."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from kinesic.bml.block import Block, Notice, NoticeType
from kinesic.bml.parse import parse
from kinesic.bml.reading.document import read_document
from kinesic.bml.reading.prologue import first_tag
from kinesic.bml.reading.tree import Element
from kinesic.intent.behaviour_sets import BehaviourSets, own_sets
from kinesic.intent.budget import GAPS, MovementBudget
from kinesic.intent.choosing import Selection, choose_behaviours
from kinesic.intent.fml.intentions import IN_SPEECH, Unreadable, read_intentions
from kinesic.intent.fml.mark_times import estimate_mark_times
from kinesic.intent.greta.agent import Agent
from kinesic.intent.intents import Intent
from kinesic.intent.markup import escape, quote
from kinesic.intent.writing import write_behaviours

START = 4096  # letters within which a document says what it is
ROOT = "fml-apml"


def is_fml(text: str | bytes) -> bool:
    """Checks whether a text begins as an FML-APML document."""
    start = text[:START] if isinstance(text, str) else text[:START].decode("utf-8", "replace").replace("\0", "")
    return first_tag(start[max(start.find("<"), 0) :]) == ROOT  # marks of the encoding may go before it


def author_fml(
    text: str | bytes,
    *,
    source: str = "<text>",
    sets: BehaviourSets | None = None,
    agent: Agent | None = None,
    seed: int = 0,
) -> tuple[str, tuple[str, ...]]:
    """Writes BML for an FML-APML document; the same document, sets and seed have the same BML.

    Args:
        text: the document.
        source: its name, for messages.
        sets: behaviours by intention; None: those that come with kinesic.
        agent: whose expressivity and preferences count; None: nobody's.
        seed: of what is drawn among alternatives.

    Returns:
        The BML, and for each intention that nothing shows its name and why.

    Raises:
        BmlError: the document is refused.
    """
    document = read_document(text, source=source)
    bml, marks = document.bml, estimate_mark_times(document.bml)
    roots = [child for child in document.root.children if child.local == "fml"]
    speeches = [child for child in bml.children if child.local == "speech"]
    read = list(read_intentions(roots, speeches, marks))
    intents = [each for each in read if isinstance(each, Intent)]
    selection = choose_behaviours(
        intents, sets or own_sets(), MovementBudget(len(intents), GAPS, {}), seed=seed, agent=agent
    )
    unshown = (
        *(f"{each.name}: {each.why}" for each in read if isinstance(each, Unreadable)),
        *_unshown(intents, selection),
    )
    taken = frozenset(each.attributes.get("id", "") for each in _all(bml))
    inside = "".join(f"  {each}\n" for each in write_behaviours(selection.behaviours, taken))
    return f"{_opened(document.root, bml)}{_written(bml.content).rstrip()}\n{inside}</{bml.name}>\n", unshown


def parse_fml(
    text: str | bytes,
    *,
    source: str = "<text>",
    performer: str | None = None,
    sets: BehaviourSets | None = None,
    agent: Agent | None = None,
    seed: int = 0,
) -> Block:
    """Reads the BML that is written for an FML-APML document; its notices say which intentions nothing shows, and why.

    Raises:
        BmlError: the document is refused.
    """
    bml, unshown = author_fml(text, source=source, sets=sets, agent=agent, seed=seed)
    block = parse(bml, source=source, dialect="fml-apml", performer=performer)
    notices = tuple(Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, block.id, f"not shown: {each}") for each in unshown)
    return replace(block, notices=(*block.notices, *notices))


def _unshown(intents: Sequence[Intent], selection: Selection) -> Iterator[str]:
    shown = {each.intent.reason for each in selection.behaviours}
    whys: dict[str, dict[str, None]] = {}
    for each in selection.omissions:
        whys.setdefault(each.intent.reason, {})[each.why] = None
    for intent in intents:
        if intent.reason not in shown:
            reasons = whys.get(intent.reason, {})
            yield f"{intent.name}, {intent.reason}: {'; '.join(reasons) or 'its choice is to show nothing'}"


def _all(element: Element) -> Iterator[Element]:
    yield element
    for child in element.children:
        yield from _all(child)


def _opened(root: Element, bml: Element) -> str:
    """The start tag of the block, with what the root says of it."""
    composed = {
        name: text for name, text in root.attributes.items() if name.startswith("xmlns") or name == "composition"
    }
    return _tag(bml.name, composed | dict(bml.attributes) | {"xmlns:kinesic": "urn:kinesic"}) + ">"


def _written(content: Sequence[Element | str]) -> str:
    """Writes what is inside an element as XML, without accents and boundaries: behaviours show them."""
    pieces = []
    for piece in content:
        if isinstance(piece, str):
            pieces.append(escape(piece))
        elif piece.local not in IN_SPEECH:
            inside = _written(piece.content)
            tag = _tag(piece.written, piece.attributes)
            pieces.append(f"{tag}>{inside}</{piece.written}>" if inside else f"{tag}/>")
    return "".join(pieces)


def _tag(name: str, attributes: Mapping[str, str]) -> str:
    return " ".join([f"<{name}", *(f"{key}={quote(value)}" for key, value in attributes.items())])
