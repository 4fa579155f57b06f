"""Notices about attributes, elements and text without effect."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from kinesic.bml.block import NoticeType
from kinesic.bml.reading.elements import OFFSET_DIRECTIONS
from kinesic.bml.reading.manner import GRETA_FIELDS
from kinesic.bml.reading.namespaces import is_core, list_unknown_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.script import FILE_ATTRIBUTES, SSML_TYPE, WAV_TYPES, find_spoken_element
from kinesic.bml.reading.sync_names import find_sync_name
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import (
    AGENT_ATTRIBUTES,
    BEHAVIOUR_ATTRIBUTES,
    BLOCK_ATTRIBUTES,
    NEEDED_ATTRIBUTES,
    NESTED_ATTRIBUTES,
    NESTED_ELEMENTS,
    NOTATION_TYPES,
    SPEECH_ATTRIBUTES,
    SUPPORTED_VALUES,
    SYNONYMOUS_ATTRIBUTES,
    UNSET_VALUES,
)

MAX_EXCERPT_LENGTH = 30  # [characters] longest quotation of document text in a message

# elements without effect as direct children of a <bml>
INEFFECTIVE_ELEMENTS = frozenset({"description", "tm", "sync", "pitchaccent", "boundary"})


def note_unread(root: Element, bml: Element, nodes: Iterable[BehaviourElement], reading: DocumentReading) -> None:
    """Add notices about attributes, elements and text without effect.

    Behaviours of unknown types are skipped here, since they are dropped by name later.

    Args:
        root: root element of the document.
        bml: its <bml>.
        nodes: the behaviours in their performed form.
        reading: receives the notices.
    """
    notes = _Notes(reading)
    for element in _find_outer_elements(root, bml):
        notes.note_element(element, root)
    notes.note_block(bml, BLOCK_ATTRIBUTES)
    for behaviour in nodes:
        if is_core(behaviour.element, home=reading.home) and behaviour.element.local in BEHAVIOUR_ATTRIBUTES:
            notes.note_behaviour(behaviour.element)


def _find_outer_elements(root: Element, bml: Element) -> Iterator[Element]:
    """Yield the outermost elements that are neither in nor around the <bml>."""
    if root is not bml:
        for child in root.children:
            yield from _find_outer_elements(child, bml) if _contains(child, bml) else (child,)


def _contains(element: Element, bml: Element) -> bool:
    return element is bml or any(_contains(child, bml) for child in element.children)


@dataclass
class _Notes:
    """Collector of notices about ineffective attributes, elements and text.

    An attribute, element or text that recurs in elements of one name gives one notice.
    """

    reading: DocumentReading
    seen: set[tuple[str, str]] = field(default_factory=set)

    def note_block(self, element: Element, allowed: tuple[str, ...]) -> None:
        """Add notices about a <bml> or <required>, without its behaviours."""
        self._note_attributes(element, allowed)
        self._note_text(element)
        for child in element.children:
            if is_core(child, home=self.reading.home):
                if child.local == "required":
                    self.note_block(child, ())
                elif child.local == "constraint":
                    self._note_inside(child, NESTED_ATTRIBUTES["constraint"])
                elif child.local in INEFFECTIVE_ELEMENTS:
                    self.note_element(child, element)

    def note_behaviour(self, element: Element) -> None:
        """Add notices about ineffective attributes, elements and text in a behaviour."""
        allowed = (*BEHAVIOUR_ATTRIBUTES[element.local], *AGENT_ATTRIBUTES, "id")
        self._note_attributes(element, (*allowed, *(name for name in element.attributes if find_sync_name(name))))
        self._note_values(element)
        if element.local == "speech":
            self._note_speech(element)
        else:
            self._note_inside(element, None)

    def _note_values(self, element: Element) -> None:
        for name in _find_ineffective(element):
            problem = f"the {name} '{_shorten(element.attributes[name])}' of {_describe_place(element)} has no effect"
            self._note((name, f"{element.local}="), NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, problem)

    def note_element(self, element: Element, parent: Element) -> None:
        """Add a notice that an element has no effect in its parent."""
        problem = f"{_describe_place(element)} in <{parent.tag}> has no effect and is ignored"
        self._note((f"<{element.local}", parent.local), NoticeType.PARSING_FAILURE, problem)

    def _note_inside(self, element: Element, allowed: tuple[str, ...] | None) -> None:
        if allowed is not None:
            self._note_attributes(element, allowed)
        self._note_text(element)
        for child in element.children:
            if child.local == "description":
                self._note_description(child, element)
            elif child.local in NESTED_ELEMENTS.get(element.local, ()):
                self._note_inside(child, NESTED_ATTRIBUTES.get(child.local) or BEHAVIOUR_ATTRIBUTES[child.local])
            else:
                self.note_element(child, element)

    def _note_description(self, description: Element, parent: Element) -> None:
        """Add notices about unsupported attributes and elements of a <description>."""
        kind = description.attributes.get("type", "").strip()
        is_spoken = parent.local == "speech" and kind.lower() in {SSML_TYPE, *WAV_TYPES}
        self._note_attributes(
            description, (*NESTED_ATTRIBUTES["description"], *(FILE_ATTRIBUTES if kind.lower() in WAV_TYPES else ()))
        )
        if kind.lower() == "gretabml":
            for child in description.children:
                if child.local not in GRETA_FIELDS:
                    self.note_element(child, description)
        elif kind.lower() == SSML_TYPE and is_spoken:
            self._note_spoken(description)
        elif kind.lower() != "kinesic" and not is_spoken and not _contains_behaviour(description, self.reading):
            problem = f"the description of type '{kind}' in {_describe_place(parent)} is not supported and is ignored"
            self._note((f"type={kind}", "description"), NoticeType.PARSING_FAILURE, problem)

    def _note_speech(self, speech: Element) -> None:
        body = find_spoken_element(speech)
        for child in speech.children:
            if child.local == "description":
                self._note_description(child, speech)
            elif body is not speech and child is not body and child.local not in BEHAVIOUR_ATTRIBUTES:
                is_core_form = child.local == "text" and body.local == "description"
                if not is_core_form:
                    self.note_element(child, speech)
        if body is not speech:
            self._note_text(speech)
        if body.local != "description":
            self._note_spoken(body)

    def _note_spoken(self, element: Element) -> None:
        """Add notices about speech markup that affects neither voice nor sync points."""
        for child in element.children:
            allowed = SPEECH_ATTRIBUTES.get(child.local)
            if child.local in BEHAVIOUR_ATTRIBUTES or (child.local == "description" and element.local == "speech"):
                continue
            if allowed is not None:
                self._note_attributes(child, allowed)
                self._note_values(child)
            elif child.text.strip():
                problem = f"{_describe_place(child)} in <{element.tag}> has no effect: its text is spoken"
                self._note((f"<{child.local}", "speech"), NoticeType.PARSING_FAILURE, problem)
            else:
                self.note_element(child, element)
                continue
            self._note_spoken(child)

    def _note_attributes(self, element: Element, allowed: tuple[str, ...]) -> None:
        plain = [name for name in element.attributes if ":" not in name and name not in (*allowed, "xmlns")]
        for name in (*list_unknown_attributes(element, home=self.reading.home), *plain):
            where = "" if ":" in name else element.local
            problem = f"the attribute {name} of {_describe_place(element)} is unknown and ignored"
            self._note((name, where), NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, problem)

    def _note_text(self, element: Element) -> None:
        for piece in element.content:
            if isinstance(piece, str) and piece.strip():
                problem = f"the text '{_shorten(piece)}' in {_describe_place(element)} has no effect and is ignored"
                self._note(("text", element.local), NoticeType.PARSING_FAILURE, problem)

    def _note(self, key: tuple[str, str], kind: NoticeType, problem: str) -> None:
        if key not in self.seen:
            self.seen.add(key)
            self.reading.add_notice(kind, problem)


def _shorten(text: str) -> str:
    shown = " ".join(text.split())
    return shown if len(shown) <= MAX_EXCERPT_LENGTH else f"{shown[:MAX_EXCERPT_LENGTH]}..."


def _describe_place(element: Element) -> str:
    return f"<{element.tag}> (line {element.place.line})"


def _contains_behaviour(description: Element, reading: DocumentReading) -> bool:
    """Return whether a <description> contains exactly one supported BML behaviour."""
    inside = [
        child
        for child in description.children
        if child.local in BEHAVIOUR_ATTRIBUTES and is_core(child, home=reading.home)
    ]
    return len(inside) == 1


def _find_ineffective(element: Element) -> Iterator[str]:
    """Yield attributes of an element whose value has no effect.

    Either a synonymous attribute takes precedence, or the value is unsupported.
    """
    values = {name: value.strip().lower() for name, value in element.attributes.items() if value.strip()}
    for names in SYNONYMOUS_ATTRIBUTES.get(element.local, ()):
        first, *others = [name for name in names if name in values] or [""]
        yield from (name for name in others if values[name] not in (*NOTATION_TYPES, values[first]))
    for (local, name), empty in SUPPORTED_VALUES.items():
        if local == element.local and name in values and values[name] not in empty:
            yield name
    for (local, name), other in NEEDED_ATTRIBUTES.items():
        value = values.get(name, "")
        is_known = name != "offsetDirection" or value.upper().replace("_", "") in OFFSET_DIRECTIONS
        if local == element.local and value not in UNSET_VALUES and is_known and values.get(other, "") in UNSET_VALUES:
            yield name
    if element.local == "say-as" and "detail" in values and values.get("interpret-as") != "tts:digits":
        yield "detail"
    if element.local == "speech" and "text" in values and find_spoken_element(element).text.strip():
        yield "text"
