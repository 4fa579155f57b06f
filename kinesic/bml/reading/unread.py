"""Says what of a document has no effect: attributes, elements and text that nobody reads, each kind of them once."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from kinesic.bml.block import NoticeType
from kinesic.bml.reading.elements import DIRECTIONS
from kinesic.bml.reading.manner import GRETA_FIELDS
from kinesic.bml.reading.namespaces import foreign_attributes, is_core
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.script import FILES, SSML, WAV, spoken_part
from kinesic.bml.reading.sync_names import sync_name
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import (
    AGENTS,
    ALTERNATIVES,
    ATTRIBUTES,
    BLOCK_ATTRIBUTES,
    EMPTY,
    EMPTY_VALUES,
    INSIDE,
    KINDS,
    NEEDED_ATTRIBUTES,
    PARTS,
    SPOKEN,
)

CHARACTERS_SHOWN = 30  # characters of a text in a message

STRAY = frozenset({"description", "tm", "sync", "pitchaccent", "boundary"})  # of a block itself, where they say nothing


def note_unread(root: Element, bml: Element, named: Iterable[BehaviourElement], reading: DocumentReading) -> None:
    """Notes what has no effect in a document; behaviours of unknown types, which are dropped by name, are left out.

    Args:
        root: of the document.
        bml: its <bml>.
        named: the behaviours in the form in which they are performed.
        reading: gets the notices.
    """
    notes = _Notes(reading)
    for element in _beside(root, bml):
        notes.note_element(element, root)
    notes.note_block(bml, BLOCK_ATTRIBUTES)
    for behaviour in named:
        if is_core(behaviour.element, home=reading.home) and behaviour.element.local in ATTRIBUTES:
            notes.note_behaviour(behaviour.element)


def _beside(root: Element, bml: Element) -> Iterator[Element]:
    """Yields the outermost elements that neither hold the <bml> nor are in it."""
    if root is not bml:
        for child in root.children:
            yield from _beside(child, bml) if _holds(child, bml) else (child,)


def _holds(element: Element, bml: Element) -> bool:
    return element is bml or any(_holds(child, bml) for child in element.children)


@dataclass
class _Notes:
    """Notices about one document, each kind once."""

    reading: DocumentReading
    seen: set[tuple[str, str]] = field(default_factory=set)

    def note_block(self, element: Element, known: tuple[str, ...]) -> None:
        """Notes what a <bml> or a <required> has beside its behaviours."""
        self._note_attributes(element, known)
        self._note_text(element)
        for child in element.children:
            if is_core(child, home=self.reading.home):
                if child.local == "required":
                    self.note_block(child, ())
                elif child.local == "constraint":
                    self._note_inside(child, INSIDE["constraint"])
                elif child.local in STRAY:
                    self.note_element(child, element)

    def note_behaviour(self, element: Element) -> None:
        """Notes what nobody reads of a behaviour."""
        known = (*ATTRIBUTES[element.local], *AGENTS, "id")
        self._note_attributes(element, (*known, *(name for name in element.attributes if sync_name(name))))
        self._note_values(element)
        if element.local == "speech":
            self._note_speech(element)
        else:
            self._note_inside(element, None)

    def _note_values(self, element: Element) -> None:
        for name in _ineffective(element):
            what = f"the {name} '{_cut(element.attributes[name])}' of {_place(element)} has no effect"
            self._note((name, f"{element.local}="), NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, what)

    def note_element(self, element: Element, around: Element) -> None:
        """Notes an element that has no effect where it stands."""
        what = f"{_place(element)} in <{around.written}> has no effect and is passed over"
        self._note((f"<{element.local}", around.local), NoticeType.PARSING_FAILURE, what)

    def _note_inside(self, element: Element, known: tuple[str, ...] | None) -> None:
        if known is not None:
            self._note_attributes(element, known)
        self._note_text(element)
        for child in element.children:
            if child.local == "description":
                self._note_description(child, element)
            elif child.local in PARTS.get(element.local, ()):
                self._note_inside(child, INSIDE.get(child.local) or ATTRIBUTES[child.local])
            else:
                self.note_element(child, element)

    def _note_description(self, description: Element, around: Element) -> None:
        """Notes one that goes with the core form only as far as it is not understood."""
        kind = description.attributes.get("type", "").strip()
        is_spoken = around.local == "speech" and kind.lower() in {SSML, *WAV}
        self._note_attributes(description, (*INSIDE["description"], *(FILES if kind.lower() in WAV else ())))
        if kind.lower() == "gretabml":
            for child in description.children:
                if child.local not in GRETA_FIELDS:
                    self.note_element(child, description)
        elif kind.lower() == SSML and is_spoken:
            self._note_spoken(description)
        elif kind.lower() != "kinesic" and not is_spoken and not _is_richer(description, self.reading):
            what = f"the description of type '{kind}' in {_place(around)} is not understood and passed over"
            self._note((f"type={kind}", "description"), NoticeType.PARSING_FAILURE, what)

    def _note_speech(self, speech: Element) -> None:
        body = spoken_part(speech)
        for child in speech.children:
            if child.local == "description":
                self._note_description(child, speech)
            elif body is not speech and child is not body and child.local not in ATTRIBUTES:
                is_core_form = child.local == "text" and body.local == "description"
                if not is_core_form:
                    self.note_element(child, speech)
        if body is not speech:
            self._note_text(speech)
        if body.local != "description":
            self._note_spoken(body)

    def _note_spoken(self, element: Element) -> None:
        """Notes markup in the text of a speech that neither the voice nor a sync point takes up."""
        for child in element.children:
            known = SPOKEN.get(child.local)
            if child.local in ATTRIBUTES or (child.local == "description" and element.local == "speech"):
                continue
            if known is not None:
                self._note_attributes(child, known)
                self._note_values(child)
            elif child.text.strip():
                what = f"{_place(child)} in <{element.written}> has no effect: its text is said"
                self._note((f"<{child.local}", "speech"), NoticeType.PARSING_FAILURE, what)
            else:
                self.note_element(child, element)
                continue
            self._note_spoken(child)

    def _note_attributes(self, element: Element, known: tuple[str, ...]) -> None:
        plain = [name for name in element.attributes if ":" not in name and name not in (*known, "xmlns")]
        for name in (*foreign_attributes(element, home=self.reading.home), *plain):
            where = "" if ":" in name else element.local
            what = f"the attribute {name} of {_place(element)} is not known and passed over"
            self._note((name, where), NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, what)

    def _note_text(self, element: Element) -> None:
        for piece in element.content:
            if isinstance(piece, str) and piece.strip():
                what = f"the text '{_cut(piece)}' in {_place(element)} has no effect and is passed over"
                self._note(("text", element.local), NoticeType.PARSING_FAILURE, what)

    def _note(self, key: tuple[str, str], kind: NoticeType, what: str) -> None:
        if key not in self.seen:
            self.seen.add(key)
            self.reading.note(kind, what)


def _cut(text: str) -> str:
    shown = " ".join(text.split())
    return shown if len(shown) <= CHARACTERS_SHOWN else f"{shown[:CHARACTERS_SHOWN]}..."


def _place(element: Element) -> str:
    return f"<{element.written}> (line {element.place.line})"


def _is_richer(description: Element, reading: DocumentReading) -> bool:
    """Whether a description holds another form of the behaviour, which one of more importance goes before."""
    inside = [each for each in description.children if each.local in ATTRIBUTES and is_core(each, home=reading.home)]
    return len(inside) == 1


def _ineffective(element: Element) -> Iterator[str]:
    """Yields attributes whose value changes nothing: another one counts, or nobody follows it."""
    written = {name: value.strip().lower() for name, value in element.attributes.items() if value.strip()}
    for names in ALTERNATIVES.get(element.local, ()):
        first, *others = [name for name in names if name in written] or [""]
        yield from (name for name in others if written[name] not in (*KINDS, written[first]))
    for (local, name), empty in EMPTY.items():
        if local == element.local and name in written and written[name] not in empty:
            yield name
    for (local, name), other in NEEDED_ATTRIBUTES.items():
        value = written.get(name, "")
        is_known = name != "offsetDirection" or value.upper().replace("_", "") in DIRECTIONS
        if local == element.local and value not in EMPTY_VALUES and is_known and written.get(other, "") in EMPTY_VALUES:
            yield name
    if element.local == "say-as" and "detail" in written and written.get("interpret-as") != "tts:digits":
        yield "detail"
    if element.local == "speech" and "text" in written and spoken_part(element).text.strip():
        yield "text"
